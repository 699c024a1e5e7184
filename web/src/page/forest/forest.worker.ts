/** The worker that steps the forest, or receives its poses. */
import "galewood/client-worker";
