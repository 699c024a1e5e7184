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

/** WebGPU on the processor. Pictures need Vulkan for the page as well: without it the device is lost with the first one. */
const SOFTWARE_WEBGPU = [
  "--enable-unsafe-webgpu",
  "--use-webgpu-adapter=swiftshader",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
];

export const LAUNCH = {
  ...(existsSync(CHROMIUM) && { executablePath: CHROMIUM }),
  args: [...SOFTWARE_GRAPHICS, ...QUIET],
};

export const WEBGPU_LAUNCH = { ...LAUNCH, args: [...LAUNCH.args, ...SOFTWARE_WEBGPU] };
