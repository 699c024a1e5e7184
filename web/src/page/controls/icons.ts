/** Line icons of the toolbar, drawn on a 24-unit square. */
const SVG_NAMESPACE = "http://www.w3.org/2000/svg";

const PATHS = {
  pause: "M9 5v14 M15 5v14",
  views: "M12 5C6.5 5 3 12 3 12s3.5 7 9 7 9-7 9-7-3.5-7-9-7Z M12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6Z",
  fly: "M3 13l18-9-7 17-3-7-8-1Z M11 14l4-4",
  link: "M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1 M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1",
  photo: "M4 8h4l2-3h4l2 3h4v11H4Z M12 10a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7Z",
  film: "M3 7h12v10H3Z M15 11l6-3v8l-6-3",
  full: "M4 9V4h5 M15 4h5v5 M20 15v5h-5 M9 20H4v-5",
  trees:
    "M8 21v-6 M8 15c-3 0-5-1.6-5-4.5S5 5 8 3c3 2 5 4.600 5 7.500S11 15 8 15Z M17 21v-5 M17 16c-2 0-3.500-1.200-3.500-3.300S15 9 17 7.500c2 1.500 3.500 3.200 3.500 5.200S19 16 17 16Z",
  compare: "M12 3v18 M5 7h14 M5 7l-3 7a3.200 3.200 0 0 0 6 0Z M19 7l-3 7a3.200 3.200 0 0 0 6 0Z M8 21h8",
  undo: "M9 7H15a5 5 0 0 1 0 10H8 M9 7l3-3 M9 7l3 3",
  redo: "M15 7H9a5 5 0 0 0 0 10h7 M15 7l-3-3 M15 7l-3 3",
  share: "M9 11a3 3 0 1 0 0-6 3 3 0 0 0 0 6Z M3.500 19c0-3 2.500-5 5.500-5s5.500 2 5.500 5 M18 8v6 M15 11h6",
  embed: "M8 8l-4 4 4 4 M16 8l4 4-4 4 M13.500 6l-3 12",
  sound: "M4 10v4h3l4 4V6L7 10Z M15 9.500a4 4 0 0 1 0 5 M17.500 7a7.500 7.500 0 0 1 0 10",
} as const;

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS(SVG_NAMESPACE, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  const path = document.createElementNS(SVG_NAMESPACE, "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}
