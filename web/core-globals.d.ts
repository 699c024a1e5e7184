/**
 * What src/core may use beyond ECMAScript: globals that pages, workers and Node all have. tsconfig.core.json reads
 * this instead of the DOM library, so that core compiles without a document.
 */
declare function atob(data: string): string;

declare class TextDecoder {
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
