/** Several workers for large forests: `new Forest({ wind, worker: severalWorkers() })`. */
import { DividedWorker, type WorkerPort } from "./dividedWorker";
import { workersFor } from "./shares";

export type { WorkerPort };

/**
 * Divides the trees of a forest among `count` workers; without it 2 to 4 by the number of processor cores, or one on a computer
 * with fewer than 4. Throws RangeError for a count that is no whole number from 1 on.
 */
export function severalWorkers(
  count = workersFor(Infinity, navigator.hardwareConcurrency),
): (start: () => WorkerPort) => WorkerPort {
  if (!(Number.isInteger(count) && count >= 1))
    throw new RangeError(`count: expected a whole number from 1 on, not ${count}`);
  return (start) => (count === 1 ? start() : new DividedWorker(Array.from({ length: count }, () => start())));
}
