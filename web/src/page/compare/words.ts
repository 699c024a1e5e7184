/** The errors of a comparison in words. Pure. */
import type { Method } from "galewood/motion";
import type { Compared } from "./tracks";

/** A percentage with two significant digits. */
export const percent = (value: number) => Number(value.toPrecision(2)).toString();

/** The verdict on a method: first in the gusts on display, then in a uniform wind if that is another one. */
export function verdictLines(gusts: Compared, uniform: Compared, method: Method): string[] {
  const same = gusts.sway.every((share, frame) => share === uniform.sway[frame]);
  if (same) return [`In this wind, the same on all branches. ${inWords(gusts, method)}`];
  return [
    `In gusts, as shown. ${inWords(gusts, method)}`,
    `In a uniform wind, the same on all branches. ${inWords(uniform, method)}`,
  ];
}

/** The largest displacement and error of a method in one wind; those of the modal model if the table lacks the method. */
function inWords({ sway, error }: Compared, method: Method): string {
  const most = (share: readonly number[]) => percent(100 * Math.max(...share));
  const { max, hausdorff } = error[method] ?? error.modal;
  return (
    `Maximum displacement: ${most(sway)} % of tree height. Maximum error: ${most(max)} % of tree height ` +
    `(Hausdorff distance ${most(hausdorff)} %).`
  );
}
