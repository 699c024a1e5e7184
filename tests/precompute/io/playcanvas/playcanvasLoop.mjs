/**
 * Plays the animation of an exported GLB in PlayCanvas without a browser: node playcanvasLoop.mjs FILE.glb ANIMATION TIME_S …
 *
 * PlayCanvas reads the file, samples the animation and computes the matrices of bones and the weights of morph targets; what its
 * shaders would do with them is done here. Prints a line for each time: by mesh, the places of its vertices. Pictures are not read.
 */
import { readFileSync } from "node:fs";
import * as pc from "playcanvas";

const [file, animation, ...times] = process.argv.slice(2);
const canvas = { id: "canvas", width: 64, height: 64, addEventListener() {}, removeEventListener() {} };
const app = new pc.AppBase(canvas);
const options = new pc.AppOptions();
options.graphicsDevice = new pc.NullGraphicsDevice(canvas);
options.componentSystems = [pc.RenderComponentSystem, pc.AnimComponentSystem];
options.resourceHandlers = [pc.ContainerHandler, pc.TextureHandler, pc.AnimClipHandler, pc.RenderHandler, pc.MaterialHandler];
app.init(options);

const asset = new pc.Asset("tree", "container", { url: "tree.glb", contents: new Uint8Array(readFileSync(file)).buffer }, null, {
  image: {
    processAsync(_image, done) {
      const picture = new pc.Asset("picture", "texture", null);
      picture.resource = new pc.Texture(app.graphicsDevice, { width: 1, height: 1 });
      picture.loaded = true;
      done(null, picture);
    },
  },
});
await new Promise((ready, failed) => {
  asset.on("load", ready);
  asset.on("error", (message) => failed(new Error(message)));
  app.assets.add(asset);
  app.assets.load(asset);
});
const container = asset.resource;
const names = container.animations.map((clip) => clip.resource.name);
const track = container.animations[names.indexOf(animation)]?.resource;
if (!track) throw new Error(`no animation ${animation} in ${names}`);
const tree = container.instantiateRenderEntity();
app.root.addChild(tree);
tree.addComponent("anim", { activate: true });
tree.anim.assignAnimation("sway", track);

/** The places of a mesh instance's vertices in the world, as the vertex shader computes them. */
function places({ mesh, node, skinInstance, morphInstance }, moment) {
  const at = [];
  mesh.getPositions(at);
  const count = at.length / 3;
  if (morphInstance) {
    const { targets } = morphInstance.morph;
    for (const [k, target] of targets.entries()) {
      const weight = morphInstance.getWeight(k);
      target.deltaPositions.forEach((delta, i) => {
        at[i] += weight * delta;
      });
    }
  }
  if (!skinInstance) {
    const world = node.getWorldTransform();
    return Array.from({ length: count }, (_, v) => {
      const { x, y, z } = world.transformPoint(new pc.Vec3(at[3 * v], at[3 * v + 1], at[3 * v + 2]));
      return [x, y, z];
    });
  }
  skinInstance.updateMatrices(node, moment); // they are kept for the same number
  const [bones, weights] = [[], []];
  mesh.getVertexStream(pc.SEMANTIC_BLENDINDICES, bones);
  mesh.getVertexStream(pc.SEMANTIC_BLENDWEIGHT, weights);
  return Array.from({ length: count }, (_, v) => {
    const rest = new pc.Vec3(at[3 * v], at[3 * v + 1], at[3 * v + 2]);
    const found = new pc.Vec3();
    for (let k = 0; k < 4; k++) {
      const moved = skinInstance.matrices[bones[4 * v + k]].transformPoint(rest);
      found.add(moved.mulScalar(weights[4 * v + k]));
    }
    const { x, y, z } = node.getWorldTransform().transformPoint(found);
    return [x, y, z];
  });
}

for (const [moment, time_s] of times.map(Number).entries()) {
  tree.anim.baseLayer.activeStateCurrentTime = time_s;
  app.systems.fire("animationUpdate", 0);
  const instances = tree.findComponents("render").flatMap((render) => render.meshInstances);
  const meshes = instances.map((one) => ({ name: one.node.name, places: places(one, moment) }));
  console.log(JSON.stringify({ names, meshes }));
}
