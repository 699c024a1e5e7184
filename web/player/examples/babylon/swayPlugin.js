/** Moves the vertices of a material by the nodes of `galewood/core`: each is held between two nodes, and turns about its joint. */
import { MaterialPluginBase } from "@babylonjs/core/Materials/materialPluginBase.js";

const DEFINITIONS = /* glsl */ `
attribute vec4 joint; // two nodes, share of the second
attribute vec3 pivot; // place of the joint
uniform highp sampler2D swayNodes; // a row per tree: displacement and rotation of each node
vec3 swayArm(vec3 arm, vec3 curl) {
  float squared = dot(curl, curl);
  vec3 axis = curl * inversesqrt(sqrt(1.0 + squared * squared));
  float cosine = sqrt(max(0.0, 1.0 - dot(axis, axis)));
  return cosine * arm + cross(axis, arm) + axis * (dot(axis, arm) / (1.0 + cosine));
}
vec3 swayAt(int texel) {
  int first = 2 * int(joint.x + 0.5) + texel;
  int second = 2 * int(joint.y + 0.5) + texel;
  int row = int(swayTree + 0.5);
  return mix(texelFetch(swayNodes, ivec2(first, row), 0).xyz, texelFetch(swayNodes, ivec2(second, row), 0).xyz, joint.z);
}
`;

export class SwayPlugin extends MaterialPluginBase {
  /** `nodes`: texture of the nodes; the number of its tree is in the metadata of each mesh. */
  constructor(material, nodes) {
    super(material, "Sway", 200, { SWAY: true }, true, true);
    this.nodes = nodes;
  }

  getClassName() {
    return "SwayPlugin";
  }

  getAttributes(attributes) {
    attributes.push("joint", "pivot");
  }

  getSamplers(samplers) {
    samplers.push("swayNodes");
  }

  getUniforms() {
    return { ubo: [{ name: "swayTree", size: 1, type: "float" }], vertex: "uniform float swayTree;" };
  }

  hardBindForSubMesh(uniforms, _scene, _engine, subMesh) {
    uniforms.updateFloat("swayTree", subMesh.getRenderingMesh().metadata.tree);
    uniforms.setTexture("swayNodes", this.nodes);
  }

  getCustomCode(shaderType) {
    if (shaderType !== "vertex") return null;
    return {
      CUSTOM_VERTEX_DEFINITIONS: DEFINITIONS,
      CUSTOM_VERTEX_UPDATE_POSITION:
        "positionUpdated = pivot + swayAt(0) + swayArm(positionUpdated - pivot, swayAt(1));",
      CUSTOM_VERTEX_UPDATE_NORMAL: "normalUpdated = swayArm(normalUpdated, swayAt(1));",
    };
  }
}
