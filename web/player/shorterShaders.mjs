/** Plugin: shader code without comments, and without spaces where it is neither a directive nor TypeScript. */
import { edited } from "./shortNames.mjs";

/** An expression of TypeScript, or an operator; a space before an expression stays, because it may be negative. */
const EXPRESSION_OR_OPERATOR = /(\$\{[^}]*\})| *([=+\-*/,;(){}<>?:])(?: +(?![ $]))?/g;

const short = (text) =>
  text
    .slice("/* glsl */ ".length)
    .replace(/\/\*[\s\S]*?\*\/|\/\/.*$/gm, "")
    .replace(/\s*\n\s*/g, "\n")
    .replace(/^[^#\n]*$/gm, (line) => line.replace(EXPRESSION_OR_OPERATOR, "$1$2"));

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
