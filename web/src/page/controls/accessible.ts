/** Associates the labels of Tweakpane, which are plain text, with their inputs for screen readers. */
export function labelInputs(root: HTMLElement): void {
  for (const row of root.querySelectorAll<HTMLElement>(".tp-lblv")) {
    const label = row.querySelector(".tp-lblv_l")?.textContent ?? "";
    for (const input of row.querySelectorAll<HTMLElement>("input, select, textarea")) {
      input.setAttribute("aria-label", label);
    }
    for (const track of row.querySelectorAll<HTMLElement>(".tp-sldv_t")) {
      // The text field beside it has the same value and keyboard steps.
      track.setAttribute("aria-hidden", "true");
      track.tabIndex = -1;
    }
  }
}
