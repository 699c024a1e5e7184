/** Rows of a text table; the file is split into cells by Papa Parse. */
import Papa from "papaparse";
import { decoded, delimiterOf, type Row, rowsOf } from "../../core/files/delimited";

/** The rows of a text that are not empty. */
export function readRows(text: string): Row[] {
  const { data } = Papa.parse<string[]>(text, { delimiter: delimiterOf(text), newline: "\n" });
  return rowsOf(data);
}

/** The text of a file in the usual encodings. */
export function textOf(bytes: Uint8Array): string {
  return decoded(bytes, (label, fatal) => new TextDecoder(label, { fatal }).decode(bytes));
}
