/** Base64 (RFC 4648). */

// browsers, workers and Node have it, but it is not part of the language's library
declare function atob(text: string): string;

const BASE64_DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/** The bytes of a valid text. */
export const bytesOfBase64 = (text: string): Uint8Array<ArrayBuffer> =>
  Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

export function textOfBase64(bytes: Uint8Array): string {
  let text = "";
  for (let i = 0; i < bytes.length; i += 3) {
    const bits = (bytes[i] << 16) | ((bytes[i + 1] ?? 0) << 8) | (bytes[i + 2] ?? 0);
    const four = [18, 12, 6, 0].map((shift) => BASE64_DIGITS[(bits >> shift) & 63]).join("");
    text += i + 2 < bytes.length ? four : four.slice(0, bytes.length - i + 1).padEnd(4, "=");
  }
  return text;
}
