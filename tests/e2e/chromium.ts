/** Launch options of Chromium with software rendering. */
import { existsSync } from "node:fs";

const CHROMIUM = "/usr/bin/chromium";
const SOFTWARE_GRAPHICS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const QUIET = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

export const LAUNCH = {
  ...(existsSync(CHROMIUM) && { executablePath: CHROMIUM }),
  args: [...SOFTWARE_GRAPHICS, ...QUIET],
};
