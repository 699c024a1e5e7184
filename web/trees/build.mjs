/** Builds the package into dist/: the tables and light meshes of the built-in trees, and a module for each. */
import { copyFileSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const HERE = fileURLToPath(new URL(".", import.meta.url));
const SPECIES = fileURLToPath(new URL("../../assets/species/", import.meta.url));
const DIST = join(HERE, "dist");
/** Lengths of parts of a GLB: its head, and the head of a chunk. */
const GLB_HEAD = 12;
const CHUNK_HEAD = 8;
const MEDIA_TYPES = { webp: "image/webp", png: "image/png", jpg: "image/jpeg" };

/** Bytes up to a multiple of four. */
const padded = (bytes, filler) => Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);

function chunk(type, bytes) {
  const head = Buffer.alloc(CHUNK_HEAD);
  head.writeUInt32LE(bytes.length, 0);
  head.write(type, 4, "latin1");
  return Buffer.concat([head, bytes]);
}

/** A GLB with its pictures inside: bundlers rename files, and would not find those that a GLB refers to. */
function withPictures(glb, folder) {
  const size = glb.readUInt32LE(GLB_HEAD);
  const start = GLB_HEAD + CHUNK_HEAD;
  const document = JSON.parse(glb.toString("utf8", start, start + size));
  const parts = [padded(glb.subarray(start + size + CHUNK_HEAD), 0)];
  let end = parts[0].length;
  for (const image of document.images) {
    const picture = readFileSync(join(folder, image.uri));
    image.mimeType = MEDIA_TYPES[image.uri.split(".").at(-1)];
    image.bufferView = document.bufferViews.length;
    delete image.uri;
    document.bufferViews.push({ buffer: 0, byteOffset: end, byteLength: picture.length });
    parts.push(padded(picture, 0));
    end += parts.at(-1).length;
  }
  for (const material of document.materials) delete material.extras; // a picture that only the page draws
  document.buffers[0].byteLength = end;
  const head = Buffer.from(glb.subarray(0, GLB_HEAD));
  const body = [
    chunk("JSON", padded(Buffer.from(JSON.stringify(document)), " ")),
    chunk("BIN\0", Buffer.concat(parts)),
  ];
  head.writeUInt32LE(GLB_HEAD + body[0].length + body[1].length, 8);
  return Buffer.concat([head, ...body]);
}

/** The module of a tree. Bundlers take an address along if both of its parts stand there as they are. */
function moduleOf({ id, name, species, form, height_m, credits }, bare) {
  const url = (file) => `new URL("./files/${file}", import.meta.url).href`;
  const facts = Object.entries({ id, name, species, form, height_m, credits });
  return `export default {
${facts.map(([key, value]) => `  ${key}: ${JSON.stringify(value)},`).join("\n")}
  tableUrl: ${url(`${id}.table`)},
  bareTableUrl: ${bare ? url(`${id}.bare.table`) : null},
  meshUrl: ${url(`${id}.glb`)},
};
`;
}

const trees = JSON.parse(readFileSync(join(SPECIES, "species.json"), "utf8"));
const nameOf = (id) => id.replace(/-(.)/g, (_, letter) => letter.toUpperCase());
rmSync(DIST, { recursive: true, force: true });
mkdirSync(join(DIST, "files"), { recursive: true });
for (const tree of trees) {
  const bare = existsSync(join(SPECIES, "shipped", `${tree.id}.bare.table`)); // evergreens have none
  for (const file of [`${tree.id}.table`, ...(bare ? [`${tree.id}.bare.table`] : [])]) {
    copyFileSync(join(SPECIES, "shipped", file), join(DIST, "files", file));
  }
  const glb = readFileSync(join(SPECIES, "light", `${tree.id}.glb`));
  writeFileSync(join(DIST, "files", `${tree.id}.glb`), withPictures(glb, join(SPECIES, "light")));
  writeFileSync(join(DIST, `${tree.id}.js`), moduleOf(tree, bare));
}
const ids = trees.map(({ id }) => id);
writeFileSync(
  join(DIST, "index.js"),
  [
    ...ids.map((id) => `import ${nameOf(id)} from "./${id}.js";`),
    `\nexport { ${ids.map(nameOf).join(", ")} };`,
    `export const TREES = [${ids.map(nameOf).join(", ")}];\n`,
  ].join("\n"),
);
writeFileSync(
  join(DIST, "index.d.ts"),
  [
    'import type { BuiltinTree } from "./tree.js";\n',
    'export type { BuiltinTree, TreeId } from "./tree.js";',
    ...ids.map((id) => `export declare const ${nameOf(id)}: BuiltinTree;`),
    "/** All of them. */\nexport declare const TREES: readonly BuiltinTree[];\n",
  ].join("\n"),
);
copyFileSync(join(HERE, "tree.d.ts"), join(DIST, "tree.d.ts"));
