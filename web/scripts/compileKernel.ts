/** Compiles kernel/modal.ts (AssemblyScript) to WebAssembly with SIMD. */
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import asc from "assemblyscript/asc";

const KERNEL_FOLDER = join(dirname(fileURLToPath(import.meta.url)), "../kernel");
/**
 * The caller provides the memory; nothing is allocated, so no garbage collector is needed. `s`: code that is repeated less; a
 * quarter smaller, and no slower.
 */
const OPTIONS = ["--runtime", "stub", "-O3s", "--noAssert", "--enable", "simd", "--importMemory"];

/** Compiles the source; throws the compiler's messages on failure. */
export async function compileKernel(): Promise<Uint8Array> {
  let made: Uint8Array | null = null;
  const { error, stderr } = await asc.main(["modal.ts", ...OPTIONS, "--outFile", "modal.wasm"], {
    readFile: (name) => {
      try {
        return readFileSync(join(KERNEL_FOLDER, name), "utf8");
      } catch {
        return null;
      }
    },
    writeFile: (name, content) => {
      if (name === "modal.wasm") made = content as Uint8Array;
    },
    listFiles: () => [],
  });
  if (error || !made) throw new Error(`${error?.message ?? "nothing was compiled"}\n${stderr.toString()}`);
  return made;
}

/** Source of the module that contains the compiled kernel, in hexadecimal, which compresses better than base64. */
export async function kernelModule(): Promise<string> {
  const text = Buffer.from(await compileKernel()).toString("hex");
  return `// Written by \`npm run kernel\` from ../kernel/modal.ts.\nexport const MODAL_KERNEL =\n  "${text}";\n`;
}
