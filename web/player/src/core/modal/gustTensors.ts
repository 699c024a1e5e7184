/** Tensors of the gust layer: G places, L oscillators (spec/formats/table.md). */
export interface GustTensors {
  readonly place: Float32Array;
  readonly step: Float32Array;
  readonly load: Float32Array;
  readonly drag: Float32Array;
}
