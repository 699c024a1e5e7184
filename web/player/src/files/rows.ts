/** Rows of a text table; the file is split into cells by Papa Parse. */
import Papa from "papaparse";
import { decoded, delimiterOf, type Row, rowsOf } from "../core/files/delimited";

/** A text file: its text, or its bytes in one of the usual encodings. */
export type TextFile = string | ArrayBuffer | Uint8Array;

/** The text of a file. */
export function textOf(file: TextFile): string {
  if (typeof file === "string") return file;
  const bytes = file instanceof Uint8Array ? file : new Uint8Array(file);
  return decoded(bytes, (label, fatal) => new TextDecoder(label, { fatal }).decode(bytes));
}

/** The rows of a file that are not empty. */
export function readRows(file: TextFile): Row[] {
  const text = textOf(file);
  const { data } = Papa.parse<string[]>(text, { delimiter: delimiterOf(text), newline: "\n" });
  return rowsOf(data);
}
