/** Writes src/tangentKernel.wasm.ts: npm run kernel */
import { writeFileSync } from "node:fs";
import { kernelModule } from "./compileKernel";

writeFileSync("src/tangentKernel.wasm.ts", await kernelModule());
