/** Tweakpane draws labels as plain text: ties each to its inputs, for screen readers. */
export function labelInputs(root: HTMLElement): void {
  for (const row of root.querySelectorAll<HTMLElement>(".tp-lblv")) {
    const label = row.querySelector(".tp-lblv_l")?.textContent ?? "";
    for (const input of row.querySelectorAll<HTMLElement>("input, select, textarea")) {
      input.setAttribute("aria-label", label);
    }
    for (const track of row.querySelectorAll<HTMLElement>(".tp-sldv_t")) {
      // The text field beside it says the same with keyboard steps of its own.
      track.setAttribute("aria-hidden", "true");
      track.tabIndex = -1;
    }
  }
}
