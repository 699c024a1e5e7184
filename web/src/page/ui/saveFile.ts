/** Saves data as a file in the visitor's downloads. */

/** The browser may read the data some time after the click. */
const KEPT_MS = 10_000;

export function saveFile(data: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(data);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
}
