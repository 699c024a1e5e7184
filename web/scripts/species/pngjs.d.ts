declare module "pngjs" {
  /** The part of pngjs that we use (it ships no types). */
  export class PNG {
    constructor(options: { width: number; height: number });
    width: number;
    height: number;
    data: Uint8Array;
    static sync: {
      write(
        png: PNG,
        options?: { colorType?: number; inputColorType?: number; deflateLevel?: number },
      ): Buffer;
      read(data: Uint8Array): PNG;
    };
  }
}
