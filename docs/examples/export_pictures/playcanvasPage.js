// A page that draws an exported GLB with its animation in PlayCanvas. window.draw(file, time_s, height_m).
import * as pc from "playcanvas";

const canvas = document.querySelector("canvas");
const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ["webgl2"], antialias: true, preserveDrawingBuffer: true });
const options = new pc.AppOptions();
options.graphicsDevice = device;
options.componentSystems = [pc.AnimComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem, pc.RenderComponentSystem];
options.resourceHandlers = [pc.AnimClipHandler, pc.ContainerHandler, pc.MaterialHandler, pc.RenderHandler, pc.TextureHandler];
const app = new pc.AppBase(canvas);
app.init(options);
app.scene.ambientLight = new pc.Color(0.55, 0.58, 0.6);
app.autoRender = false;
app.start();

window.draw = async (file, time_s, height_m) => {
  const asset = new pc.Asset("tree", "container", { url: file });
  await new Promise((ready, failed) => {
    asset.on("load", ready);
    asset.on("error", (message) => failed(new Error(message)));
    app.assets.add(asset);
    app.assets.load(asset);
  });
  const tree = asset.resource.instantiateRenderEntity();
  const [clip] = asset.resource.animations;
  tree.addComponent("anim", { activate: true });
  tree.anim.assignAnimation("sway", clip.resource, undefined, 0); // at speed 0: the picture is of one moment
  const sun = new pc.Entity("sun");
  sun.addComponent("light", { type: "directional", intensity: 1.6 });
  sun.setEulerAngles(35, 45, 0);
  const camera = new pc.Entity("camera");
  camera.addComponent("camera", { fov: 30, farClip: 1000, clearColor: new pc.Color(188 / 255, 214 / 255, 234 / 255) });
  camera.setPosition(0, 0.47 * height_m, 2.2 * height_m);
  for (const entity of [tree, sun, camera]) app.root.addChild(entity);
  app.systems.fire("animationUpdate", 0); // the clip begins
  tree.anim.baseLayer.activeStateCurrentTime = time_s;
  await new Promise((drawn) => {
    app.once("frameend", drawn);
    app.renderNextFrame = true;
  });
};
window.ready = true;
