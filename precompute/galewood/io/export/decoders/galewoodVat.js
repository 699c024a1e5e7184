// three.js: plays trees whose looping sway is in vertex animation textures. Written by Galewood; needs only three.
//
//   import { loadVat } from "./galewoodVat.js";
//   const tree = await loadVat("tree.json");        // EXR textures and the GLB beside it
//   scene.add(tree.object);
//   renderer.setAnimationLoop(() => { tree.time.value = performance.now() / 1000; renderer.render(scene, camera); });
//
// Many of them: scene.add(vatInstances(tree, matrices)) instead of tree.object. `vatMaterial` makes any built-in
// material sway.
import {
	Box3,
	FloatType,
	Group,
	InstancedBufferAttribute,
	InstancedMesh,
	MeshDepthMaterial,
	NearestFilter,
	RGBADepthPacking,
	Sphere,
	Vector3,
} from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const DECLARATIONS = /* glsl */ `
uniform sampler2D vatOffsetMap;
uniform sampler2D vatRotationMap;
uniform sampler2D vatPivotMap;
uniform float vatTime;
uniform float vatFrames;
uniform float vatFps;
uniform int vatRows;
attribute vec2 vatTexel;
#ifdef VAT_START
attribute float vatStart;
#endif

vec3 vatTurned(vec4 q, vec3 v) {
	return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

void vatAt(out vec3 pivot, out vec3 moved, out vec4 q) {
	ivec2 texel = ivec2(floor(vatTexel * vec2(textureSize(vatOffsetMap, 0))));
	float start = 0.0;
	#ifdef VAT_START
	start = vatStart;
	#endif
	float at = fract(vatTime * vatFps / vatFrames + start) * vatFrames;
	int first = min(int(at), int(vatFrames) - 1);
	int second = (first + 1) % int(vatFrames);
	float share = at - float(first);
	ivec2 a = texel + ivec2(0, first * vatRows);
	ivec2 b = texel + ivec2(0, second * vatRows);
	moved = mix(texelFetch(vatOffsetMap, a, 0).rgb, texelFetch(vatOffsetMap, b, 0).rgb, share);
	vec3 turn = mix(texelFetch(vatRotationMap, a, 0).rgb, texelFetch(vatRotationMap, b, 0).rgb, share);
	q = vec4(turn, sqrt(max(1.0 - dot(turn, turn), 0.0)));
	pivot = texelFetch(vatPivotMap, texel, 0).rgb;
}
`;

/** Make a built-in material sway; `vat` is the result of `loadTextures`. `start`: it has an attribute vatStart. */
export function vatMaterial(material, vat, { start = false } = {}) {
	material.defines = { ...material.defines, ...(start ? { VAT_START: "" } : {}) };
	material.customProgramCacheKey = () => `galewood-vat-${start}`;
	material.onBeforeCompile = (shader) => {
		Object.assign(shader.uniforms, vat.uniforms);
		shader.vertexShader = shader.vertexShader
			.replace("#include <common>", `#include <common>\n${DECLARATIONS}`)
			.replace(
				"#include <beginnormal_vertex>",
				`#include <beginnormal_vertex>
				vec3 vatPivot, vatMoved; vec4 vatRotation;
				vatAt(vatPivot, vatMoved, vatRotation);
				objectNormal = vatTurned(vatRotation, objectNormal);`,
			)
			.replace(
				"#include <begin_vertex>",
				`vec3 vatPivot2, vatMoved2; vec4 vatRotation2;
				vatAt(vatPivot2, vatMoved2, vatRotation2);
				vec3 transformed = vatPivot2 + vatMoved2 + vatTurned(vatRotation2, position - vatPivot2);`,
			);
	};
	return material;
}

/** The textures of a description, as uniforms for `vatMaterial`; `base`: address that its file names refer to. */
export async function loadTextures(description, base) {
	const load = async (use) => {
		const loader = new EXRLoader();
		if (use === "pivot") loader.setDataType(FloatType);
		const { file } = description.textures[use];
		if (!file.endsWith(".exr")) {
			throw new Error(`${file}: browsers read PNG with 8 bits per channel; export with --format exr`);
		}
		const texture = await loader.loadAsync(new URL(file, base).href);
		texture.minFilter = texture.magFilter = NearestFilter;
		texture.generateMipmaps = false;
		return texture;
	};
	const [offset, rotation, pivot] = await Promise.all(["offset", "rotation", "pivot"].map(load));
	// EXRLoader stores the last line of the picture first
	for (const texture of [offset, rotation, pivot]) flip(texture);
	return {
		uniforms: {
			vatOffsetMap: { value: offset },
			vatRotationMap: { value: rotation },
			vatPivotMap: { value: pivot },
			vatTime: { value: 0 },
			vatFrames: { value: description.frames },
			vatFps: { value: description.fps },
			vatRows: { value: description.rows_per_frame },
		},
	};
}

function flip(texture) {
	const { data, width, height } = texture.image;
	const line = (data.length / (width * height)) * width;
	const turned = new data.constructor(data.length);
	for (let row = 0; row < height; row++) {
		turned.set(data.subarray(row * line, (row + 1) * line), (height - 1 - row) * line);
	}
	texture.image.data = turned;
	texture.flipY = false;
	texture.needsUpdate = true;
}

/** Load a tree by the address of its JSON: an object to add to a scene, and `time` (s), to be set every frame. */
export async function loadVat(address) {
	const base = new URL(address, globalThis.location?.href);
	const description = await (await fetch(base)).json();
	const [vat, gltf] = await Promise.all([
		loadTextures(description, base),
		new GLTFLoader().loadAsync(new URL(description.mesh, base).href),
	]);
	const { low, high } = description.bounds_m;
	const box = new Box3(new Vector3(...low), new Vector3(...high));
	gltf.scene.traverse((mesh) => {
		if (!mesh.isMesh) return;
		mesh.geometry.setAttribute("vatTexel", mesh.geometry.getAttribute("uv1"));
		mesh.geometry.boundingBox = box.clone();
		mesh.geometry.boundingSphere = box.getBoundingSphere(new Sphere());
		vatMaterial(mesh.material, vat);
		mesh.customDepthMaterial = shadowMaterial(mesh.material, vat);
	});
	return { object: gltf.scene, time: vat.uniforms.vatTime, vat, description };
}

/** Many instances of a loaded tree, at `matrices` (Matrix4). `starts`: where in the loop each begins, 0..1. */
export function vatInstances(tree, matrices, starts = matrices.map((_, k) => (k * 0.618034) % 1)) {
	const group = new Group();
	tree.object.traverse((mesh) => {
		if (!mesh.isMesh) return;
		const geometry = mesh.geometry.clone();
		geometry.setAttribute("vatStart", new InstancedBufferAttribute(Float32Array.from(starts), 1));
		const material = vatMaterial(mesh.material.clone(), tree.vat, { start: true });
		const instances = new InstancedMesh(geometry, material, matrices.length);
		matrices.forEach((matrix, k) => {
			instances.setMatrixAt(k, matrix);
		});
		instances.customDepthMaterial = shadowMaterial(mesh.material, tree.vat, { start: true });
		group.add(instances);
	});
	return group;
}

function shadowMaterial({ map, alphaTest, side }, vat, options) {
	const depth = new MeshDepthMaterial({ depthPacking: RGBADepthPacking, map, alphaTest, side });
	return vatMaterial(depth, vat, options);
}
