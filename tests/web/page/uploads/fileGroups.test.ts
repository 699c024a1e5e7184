import { unzipSync } from "three/examples/jsm/libs/fflate.module.js";
import { expect, it } from "vitest";
import { type Chosen, chosenFiles, grouped, uploadOf } from "../../../../web/src/page/uploads/fileGroups";

const given = (...paths: string[]): Chosen[] =>
  paths.map((path) => ({ path, file: new File([`content of ${path}`], path.replace(/^.*\//, "")) }));
const paths = (groups: Chosen[][]) => groups.map((group) => group.map(({ path }) => path));

it("sends meshes one by one and a mesh with its textures together", () => {
  expect(paths(grouped(given("a.glb", "b.obj")))).toEqual([["a.glb"], ["b.obj"]]);
  expect(paths(grouped(given("bark.png", "tree.obj", "tree.mtl")))).toEqual([["tree.obj", "bark.png", "tree.mtl"]]);
  expect(paths(grouped(given("bark.png")))).toEqual([["bark.png"]]); // the server says that it is an image
});

it("takes from a folder what belongs to a model", () => {
  const folder = given("oak/scene.gltf", "oak/scene.bin", "oak/textures/bark.PNG", "oak/readme.txt", "oak/.DS_Store");
  expect(paths(grouped(folder))).toEqual([["oak/scene.gltf", "oak/scene.bin", "oak/textures/bark.PNG"]]);
  expect(paths(grouped(given("oak/a.glb", "oak/readme.txt")))).toEqual([["oak/a.glb"]]);
});

it("packs a group into an archive of the same files under the same paths", async () => {
  const group = given("oak/scene.gltf", "oak/scene.bin", "oak/textures/bark.png");
  const packed = await uploadOf(group);
  expect(packed.name).toBe("scene.zip");
  const entries = unzipSync(new Uint8Array(await packed.arrayBuffer()));
  const texts = Object.entries(entries).map(([path, bytes]) => [path, new TextDecoder().decode(bytes)]);
  expect(texts).toEqual(group.map(({ path }) => [path, `content of ${path}`]));
});

it("sends a single file as it is", async () => {
  const [file] = chosenFiles([new File(["x"], "a.glb")]);
  expect(await uploadOf([file!])).toBe(file!.file);
});
