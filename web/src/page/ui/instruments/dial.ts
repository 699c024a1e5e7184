/** Geometry of the wind rose: conversion between positions on the dial and winds. Pure. */

import { FASTEST_M_S } from "../../settings/windLimits";

/** Speeds of the rings; the last is the rim. */
export const RINGS_M_S = [5, 15, 30, FASTEST_M_S] as const;

export interface DialWind {
  readonly direction_deg: number;
  readonly mean_speed_m_s: number;
}

/** A position on the dial: right and down from its centre, 1 at the rim. */
export interface DialPlace {
  readonly right: number;
  readonly down: number;
}

/** Rotation of the dial (degrees) that puts the viewing direction of the camera at the top. */
export function dialTurn_deg(forward: { x: number; z: number }): number {
  return -90 - (Math.atan2(forward.z, forward.x) * 180) / Math.PI;
}

const wrap_deg = (angle: number): number => angle - 360 * Math.floor(angle / 360);

/**
 * The wind whose arrow ends at a position. The length of the arrow is the square root of the speed, the rim is the
 * maximum. Near the centre the direction is kept.
 */
export function windAtPlace({ right, down }: DialPlace, turn_deg: number, before: DialWind): DialWind {
  const radius = Math.hypot(right, down);
  const mean_speed_m_s = Math.round(Math.min(1, radius) ** 2 * FASTEST_M_S * 10) / 10;
  if (radius < 0.03) return { direction_deg: before.direction_deg, mean_speed_m_s: 0 };
  const screen_deg = (Math.atan2(down, right) * 180) / Math.PI;
  return { direction_deg: Math.round(wrap_deg(screen_deg - turn_deg)) % 360, mean_speed_m_s };
}

/** Radius of a speed on the dial, 1 at the rim. */
export const radiusOf = (speed_m_s: number): number => Math.sqrt(Math.min(1, speed_m_s / FASTEST_M_S));

/** Position of the arrow tip for a wind. */
export function placeOfWind({ direction_deg, mean_speed_m_s }: DialWind, turn_deg: number): DialPlace {
  const angle = ((direction_deg + turn_deg) * Math.PI) / 180;
  const radius = radiusOf(mean_speed_m_s);
  return { right: radius * Math.cos(angle), down: radius * Math.sin(angle) };
}

/** The wind after a key press; null for other keys. */
export function windAfterKey(key: string, { direction_deg, mean_speed_m_s }: DialWind): DialWind | null {
  const turned = (by: number) => ({ direction_deg: wrap_deg(direction_deg + by), mean_speed_m_s });
  const faster = (by: number) => ({
    direction_deg,
    mean_speed_m_s: Math.min(FASTEST_M_S, Math.max(0, mean_speed_m_s + by)),
  });
  switch (key) {
    case "ArrowLeft":
      return turned(-5);
    case "ArrowRight":
      return turned(5);
    case "ArrowUp":
      return faster(0.5);
    case "ArrowDown":
      return faster(-0.5);
    case "PageUp":
      return faster(3);
    case "PageDown":
      return faster(-3);
    case "Home":
      return { direction_deg, mean_speed_m_s: 0 };
    case "End":
      return { direction_deg, mean_speed_m_s: FASTEST_M_S };
    default:
      return null;
  }
}
