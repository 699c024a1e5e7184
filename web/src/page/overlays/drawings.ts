/** What the overlays draw on one tree. Each is in the tree's own frame, except the wind, which is in the world's. */

import type { TableMotion } from "galewood/client";
import { NodePose } from "galewood/motion";
import { heightFactor, type WindField } from "galewood/wind";
import { Group, type Object3D, Vector3 } from "three";
import { ErrorPoints } from "../../scene/overlays/errorPoints";
import { NodeBinding } from "../../scene/overlays/nodeBinding";
import { WindArrows } from "../../scene/overlays/windArrows";
import { WireFigure, type WireStyle } from "../../scene/overlays/wireFigure";
import { shownFrequency_hz } from "./modes";
import type { Structure } from "./structure";
import { type Bearing, strainColours } from "./treeStrain";

/** State of the tree in one frame. */
interface Moment {
  /** [nodes, 3] displacement of the nodes as drawn, tree frame, m. */
  readonly moved: Float32Array;
  /** [joints, 3] the same of the joints. */
  readonly jointMoved: Float32Array;
  /** Time of the forest, and by how much it advanced, s. */
  readonly time_s: number;
  readonly step_s: number;
}

export interface Drawing {
  readonly object: Object3D;
  update(moment: Moment): void;
  dispose(): void;
}

const SKELETON_STYLE: WireStyle = { colour: 0x6fd3ff, width_px: 2.5, opacity: 0.95 };
const TETRAHEDRA_STYLE: WireStyle = { colour: 0xffc163, width_px: 1, opacity: 0.55 };
const MODE_STYLE: WireStyle = { colour: 0xffb02e, width_px: 3, opacity: 1 };
const REST_STYLE: WireStyle = { colour: 0xdfe6ea, width_px: 1, opacity: 0.6 };
const STRAIN_LINE = { width_px: 5, opacity: 1 };
/** A mode is shown with this amplitude at the point that it moves most, relative to the height. */
const MODE_SHARE = 0.09;
const MOST_ARROWS = 90;

/** Lines between points that follow the tree. */
function wires(points: Float32Array, pairs: Uint32Array, motion: TableMotion, style: WireStyle): Drawing {
  const figure = new WireFigure(pairs, style);
  const binding = new NodeBinding(points, motion.jointRest_m);
  const moved = new Float32Array(points.length);
  return {
    object: figure.lines,
    update(moment) {
      binding.displace(moment.jointMoved, moved);
      figure.move(points, moved);
    },
    dispose: () => figure.dispose(),
  };
}

export const skeletonDrawing = (structure: Structure, motion: TableMotion): Drawing =>
  wires(structure.points_m, structure.links, motion, SKELETON_STYLE);

export const tetrahedraDrawing = (structure: Structure, motion: TableMotion): Drawing =>
  wires(structure.vertices_m, structure.edges, motion, TETRAHEDRA_STYLE);

/** The axes of the wood in the colours of its strain. */
export function strainDrawing({ points_m, links, strain, largest }: Bearing, motion: TableMotion): Drawing {
  return wires(points_m, links, motion, { ...STRAIN_LINE, colour: strainColours(strain, largest) });
}

/** The skeleton swinging in one natural mode about its rest pose. */
export function modeDrawing({ points_m, links }: Structure, motion: TableMotion, mode: number): Drawing {
  const { height_m, jointRest_m, stride } = motion;
  const only = new Float32Array(stride);
  only[mode] = 1e-3; // so little that nothing is shortened
  const shape = new NodePose(motion).take(only).jointMoved;
  const binding = new NodeBinding(points_m, jointRest_m);
  const moved = new Float32Array(points_m.length);
  binding.displace(shape, moved);
  let most = 1e-12;
  for (let i = 0; i < moved.length; i += 3) most = Math.max(most, Math.hypot(...moved.subarray(i, i + 3)));
  const amplitude = moved.map((value) => (value * MODE_SHARE * height_m) / most);
  const [rest, swinging] = [new WireFigure(links, REST_STYLE), new WireFigure(links, MODE_STYLE)];
  rest.move(points_m, new Float32Array(points_m.length));
  const object = new Group();
  object.add(rest.lines, swinging.lines);
  const hz = shownFrequency_hz(motion.frequencies_hz[mode]);
  let turns = 0;
  return {
    object,
    update({ step_s }) {
      turns = (turns + hz * step_s) % 1;
      const now = Math.sin(2 * Math.PI * turns);
      for (let i = 0; i < moved.length; i++) moved[i] = now * amplitude[i];
      swinging.move(points_m, moved);
    },
    dispose() {
      rest.dispose();
      swinging.dispose();
    },
  };
}

export function errorDrawing(error_m: Float32Array, motion: TableMotion): Drawing {
  const worst_m = Math.max(1e-9, ...error_m);
  const dots = new ErrorPoints(error_m.map((error) => error / worst_m));
  return {
    object: dots.points,
    update: ({ moved }) => dots.move(motion.rest_m, moved),
    dispose: () => dots.dispose(),
  };
}

/** The wind at nodes spread over the crown; `frame` is the group that stands where the tree stands. */
export function windDrawing(field: WindField, motion: TableMotion, frame: Object3D): Drawing {
  const every = Math.max(1, Math.ceil(motion.nodes / MOST_ARROWS));
  const chosen = Array.from({ length: Math.floor(motion.nodes / every) }, (_, k) => k * every);
  const arrows = new WindArrows(chosen.length);
  const [x, z, vx, vz] = Array.from({ length: 4 }, () => new Float64Array(chosen.length));
  const height_m = new Float64Array(chosen.length);
  const y = new Float64Array(chosen.length);
  const place = new Vector3();
  return {
    object: arrows.mesh,
    update({ moved, time_s }) {
      frame.updateMatrixWorld();
      chosen.forEach((node, k) => {
        place.fromArray(motion.rest_m, 3 * node);
        place.set(place.x + moved[3 * node], place.y + moved[3 * node + 1], place.z + moved[3 * node + 2]);
        height_m[k] = Math.max(0.1, place.y * frame.scale.y);
        frame.localToWorld(place);
        [x[k], y[k], z[k]] = [place.x, place.y, place.z];
      });
      const moment = field.at(time_s);
      field.velocity(x, z, moment, vx, vz);
      const { mean_speed_m_s, height_exponent, reference_height_m } = moment.wind;
      chosen.forEach((_, k) => {
        const profile = heightFactor(height_m[k], height_exponent, reference_height_m);
        place.set(x[k], y[k], z[k]);
        arrows.set(k, place, { x: profile * vx[k], z: profile * vz[k] }, mean_speed_m_s);
      });
      arrows.update();
    },
    dispose: () => arrows.dispose(),
  };
}
