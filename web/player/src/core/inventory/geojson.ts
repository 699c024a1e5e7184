/**
 * Points of a GeoJSON file (RFC 7946) as rows, so that they are read like a table.
 * Twin: precompute/galewood/inventory/geojson.py.
 */
import type { Row } from "../files/delimited";
import { InventoryError } from "./errors";

type Fields = Readonly<Record<string, unknown>>;

const fieldsOf = (value: unknown): Fields =>
  typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Fields) : {};

/** A row of names, then one row per feature, whose line is its number; throws InventoryError. */
export function rowsOfGeojson(text: string): Row[] {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch {
    throw new InventoryError("the file is not valid JSON");
  }
  const { features } = fieldsOf(document);
  if (!Array.isArray(features)) {
    throw new InventoryError("expected a GeoJSON FeatureCollection of points");
  }
  const listed = features.map(fieldsOf);
  const names = new Set(listed.flatMap(({ properties }) => Object.keys(fieldsOf(properties))));
  // names of places among the properties must not come before the geometry
  const kept = [...names].filter((name) => !["x", "y", "lon", "lat"].includes(name.toLowerCase()));
  const places = isProjected(fieldsOf(document)) ? ["x", "y"] : ["lon", "lat"];
  const rows = listed.map((feature, k) => {
    const properties = fieldsOf(feature.properties);
    return { line: k + 1, cells: [...pointOf(feature), ...kept.map((name) => textOf(properties[name]))] };
  });
  return [{ line: 0, cells: [...places, ...kept] }, ...rows];
}

/** Whether coordinates are metres: an old file names a projected reference system. */
function isProjected(document: Fields): boolean {
  const name = String(fieldsOf(fieldsOf(document.crs).properties).name ?? "");
  return name !== "" && !/(CRS84|:4326|:4258)$/.test(name);
}

function pointOf(feature: Fields): [string, string] {
  const { type, coordinates } = fieldsOf(feature.geometry);
  const place = type === "MultiPoint" && Array.isArray(coordinates) ? coordinates[0] : coordinates;
  if ((type !== "Point" && type !== "MultiPoint") || !Array.isArray(place) || place.length < 2)
    return ["", ""];
  return [textOf(place[0]), textOf(place[1])];
}

const textOf = (value: unknown): string =>
  typeof value === "string" || typeof value === "number" ? String(value).trim() : "";
