declare module "pngjs" {
  /** Types of the part of pngjs used here (the package has none). */
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
