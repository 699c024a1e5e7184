/** Plugin: shader code without comments, and without spaces where it is neither a directive nor TypeScript. */
import { edited } from "./shortNames.mjs";

const short = (text) =>
  text
    .slice("/* glsl */ ".length)
    .replace(/\/\*[\s\S]*?\*\/|\/\/.*$/gm, "")
    .replace(/\s*\n\s*/g, "\n")
    .replace(/^[^#\n$]*$/gm, (line) => line.replace(/ *([=+\-*/,;(){}<>?:]) */g, "$1"));

export const shorterShaders = {
  name: "shorter-shaders",
  transform: {
    filter: { id: /\.ts$/, code: /\/\* glsl \*\// },
    handler: (code) =>
      edited(
        code,
        Array.from(code.matchAll(/\/\* glsl \*\/ `[^`]*`/g), ({ 0: shader, index }) => [
          index,
          index + shader.length,
          short(shader),
        ]),
      ),
  },
};
