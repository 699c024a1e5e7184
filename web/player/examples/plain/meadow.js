/** Nothing special: a camera, the sun with its shadows, the sky and a meadow, for any renderer of three.js. */
import {
  Color,
  DirectionalLight,
  HemisphereLight,
  Mesh,
  MeshLambertMaterial,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
} from "three";

export const camera = new PerspectiveCamera(46, innerWidth / innerHeight, 0.3, 400);
camera.position.set(4, 4, 24);
camera.lookAt(0, 6, 0);

export const scene = new Scene();
scene.background = new Color(0xbcd6ea);
scene.add(new HemisphereLight(0xcfe4ff, 0x6d7a4a, 2.2));

const sun = new DirectionalLight(0xfff1d6, 3);
sun.position.set(14, 22, 12);
sun.castShadow = true;
sun.shadow.mapSize.set(1024, 1024);
Object.assign(sun.shadow.camera, { left: -22, right: 22, top: 22, bottom: -22, far: 80 });
sun.shadow.bias = -0.002;
scene.add(sun);

const meadow = new Mesh(new PlaneGeometry(400, 400), new MeshLambertMaterial({ color: 0x7f9a52 }));
meadow.rotation.x = -Math.PI / 2;
meadow.receiveShadow = true;
scene.add(meadow);

/** Lets a renderer fill the page, with shadows. */
export function filling(renderer) {
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = PCFShadowMap;
  renderer.setSize(innerWidth, innerHeight);
  document.body.append(renderer.domElement);
  addEventListener("resize", () => {
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
    renderer.setSize(innerWidth, innerHeight);
  });
  return renderer;
}
