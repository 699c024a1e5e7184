/** Factor of all displacements on screen, shared by the materials of trees and impostors; 1: as simulated. */
export const exaggeration = { value: 1 };
