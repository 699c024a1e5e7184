/** Writes src/core/modal/modalKernel.wasm.ts: npm run kernel */
import { writeFileSync } from "node:fs";
import { kernelModule } from "./compileKernel";

writeFileSync("src/core/modal/modalKernel.wasm.ts", await kernelModule());
