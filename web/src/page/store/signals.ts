/** Objects and subscriptions on top of signals. */
import { effect, signal, untracked } from "@preact/signals-core";

/**
 * An object whose properties are signals: an effect that reads one runs again when it is written. Values are compared
 * by identity, so lists and records are replaced, not changed in place.
 */
export function reactive<T extends object>(initial: T): T {
  const made = {} as T;
  for (const key of Object.keys(initial) as (keyof T)[]) {
    const value = signal(initial[key]);
    Object.defineProperty(made, key, {
      enumerable: true,
      get: () => value.value,
      set: (next: T[typeof key]) => {
        value.value = next;
      },
    });
  }
  return made;
}

/** Calls `then` when a value that `read` returns differs from before; returns a function that ends this. */
export function watch<const T extends readonly unknown[]>(
  read: () => T,
  then: (now: T, before: T) => void,
): () => void {
  let last: T | undefined;
  return effect(() => {
    const now = read();
    const before = last;
    last = now;
    if (before?.some((value, k) => value !== now[k])) untracked(() => then(now, before));
  });
}
