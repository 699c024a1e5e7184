/** Writes player/src/core/modal/modalKernel.wasm.ts: npm run kernel */
import { writeFileSync } from "node:fs";
import { kernelModule } from "./compileKernel";

writeFileSync("player/src/core/modal/modalKernel.wasm.ts", await kernelModule());
