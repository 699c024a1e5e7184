/**
 * Globals besides ECMAScript that src/core may use: those that pages, workers and Node have in common.
 * tsconfig.core.json uses this file instead of the DOM library, so that core cannot depend on the DOM.
 */
declare class TextDecoder {
  constructor(label?: string, options?: { fatal?: boolean });
  decode(input?: ArrayBuffer | ArrayBufferView): string;
}

declare namespace WebAssembly {
  class Module {
    constructor(bytes: BufferSource);
  }
  class Memory {
    readonly buffer: ArrayBuffer;
    constructor(descriptor: { initial: number; maximum?: number });
  }
  class Global {
    value: number;
  }
  class Instance {
    readonly exports: Record<string, unknown>;
    constructor(module: Module, imports?: Record<string, Record<string, unknown>>);
  }
}

type BufferSource = ArrayBuffer | ArrayBufferView;
