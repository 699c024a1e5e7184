/** Makes the generator bundle without the pictures of ez-tree. */
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const GENERATOR_FOLDER = dirname(fileURLToPath(import.meta.url));
export const PACKAGES = join(GENERATOR_FOLDER, "../../node_modules");
const EZ_TREE = join(PACKAGES, "@dgreenheck/ez-tree/src/lib");

/**
 * The published file of ez-tree holds four megabytes of pictures, which it loads through the DOM. Its sources do without:
 * the module of the pictures is left empty, as nothing here asks for one.
 */
export const withoutPictures = {
  name: "ez-tree-without-pictures",
  load(id: string): string | null {
    if (id === join(GENERATOR_FOLDER, "growth/ez-tree.ts"))
      return `export { Tree, TreePreset } from ${JSON.stringify(join(EZ_TREE, "index.js"))};`;
    if (id === join(EZ_TREE, "textures.js"))
      return "export const getBarkTexture = () => null, getLeafTexture = () => null;";
    return null;
  },
};
