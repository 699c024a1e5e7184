/** Grows all forms of the species into assets/species/: `npm run grow`, or some: `npm run grow poplar maple`. */
import { mkdirSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { describeSprays, drawShoots, drawSprays, growSpecies } from "./grow";
import { SPECIES } from "./parameters";
import type { Species } from "./species";

const SPECIES_FOLDER = resolve(import.meta.dirname, "../../assets/species");
const CREDITS =
  "Galewood (MIT); skeleton grown with @dgreenheck/ez-tree (MIT); leaves and bark drawn by our script";

async function write(species: Species): Promise<void> {
  const { glb, skeleton, nodes, wood, twigs, leaves } = await growSpecies(species);
  writeFileSync(`${SPECIES_FOLDER}/${species.id}.glb`, glb);
  writeFileSync(`${SPECIES_FOLDER}/${species.id}.skeleton.json`, skeleton);
  if (species.form === "open") drawForBrowsers(species);
  const branchCount = new Set(nodes.map((node) => node.branch)).size;
  const [w, t, l] = [wood, twigs, leaves].map(({ indices }) => indices.length / 3);
  const triangles = `${w} wood, ${t} twig and ${l} leaf triangles`;
  console.log(`${species.id}: ${branchCount} branches, ${triangles}, ${(glb.length / 1e6).toFixed(2)} MB`);
}

/** Pictures of both forms of a species that only browsers draw. */
function drawForBrowsers(species: Species): void {
  writeFileSync(`${SPECIES_FOLDER}/${species.wood}.sprays.png`, drawSprays(species));
  const sprays = describeSprays(species);
  if (sprays) writeFileSync(`${SPECIES_FOLDER}/${species.wood}.sprays.json`, sprays);
  const shoots = drawShoots(species);
  if (shoots) writeFileSync(`${SPECIES_FOLDER}/${species.wood}.shoots.png`, shoots);
}

mkdirSync(SPECIES_FOLDER, { recursive: true });
const wanted = process.argv.slice(3);
for (const species of SPECIES) if (wanted.length === 0 || wanted.includes(species.id)) await write(species);
const list = SPECIES.map(({ id, name, wood, form, height_m }) => ({
  id,
  name,
  file: `${id}.glb`,
  species: wood,
  form,
  height_m,
  credits: CREDITS,
}));
writeFileSync(`${SPECIES_FOLDER}/species.json`, `${JSON.stringify(list, null, 2)}\n`);
