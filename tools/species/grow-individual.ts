/**
 * Grows an individual: node FILE REQUEST, with a document (JSON) of the values of `Individual`, and `pictures`, the
 * file of the built-in tree that has its pictures. Writes tree.glb and skeleton.json to the current folder; what is wrong
 * with the values goes to refused.txt.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { readGlb, type SpeciesPictures, writeGlb } from "./glb";
import { skeletonJson } from "./growth/skeleton";
import { builtinOf, growIndividual, type Individual } from "./individual";

async function picturesOf(file: string): Promise<SpeciesPictures> {
  const textures = (await readGlb(readFileSync(file))).getRoot().listTextures();
  const image = (name: string): Uint8Array => {
    const found = textures.find((texture) => texture.getName() === name)?.getImage();
    if (!found) throw new Error(`${file} has no picture named ${name}`);
    return found;
  };
  return { bark: image("bark"), barkNormal: image("bark_normal"), leaves: image("leaves") };
}

async function write(request: Individual & { pictures: string }): Promise<void> {
  const { nodes, ...meshes } = growIndividual(request);
  const name = `${builtinOf(request).id}-${request.seed}`;
  const pictures = await picturesOf(request.pictures);
  writeFileSync("tree.glb", await writeGlb(name, meshes, builtinOf(request).twigs.colour, pictures));
  writeFileSync("skeleton.json", skeletonJson(name, nodes));
}

try {
  await write(JSON.parse(process.argv[2]));
} catch (error) {
  if (!(error instanceof RangeError)) throw error;
  writeFileSync("refused.txt", error.message);
}
