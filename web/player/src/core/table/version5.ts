/** Version 5 tables, which differ from version 6 only in names. */

import type { Container, Json } from "./container";

const FORMER_PREFIX = "tangent.";
const PREFIX = "modal.";

/** Version 6 name of a version 5 tensor. A version 6 name in a version 5 file is mapped to an unknown name. */
function presentName(name: string): string {
  if (name.startsWith(FORMER_PREFIX)) return PREFIX + name.slice(FORMER_PREFIX.length);
  return name.startsWith(PREFIX) ? `${name} of version 6` : name;
}

function withTrainingError(errors: unknown): unknown {
  if (typeof errors !== "object" || errors === null || !("replay_m" in errors)) return errors;
  const { replay_m, ...others } = errors as Json;
  return { ...others, training_m: replay_m };
}

/** A version 5 table under the names of version 6. */
export function fromVersion5({ header, body, metadata }: Container): Container {
  const tensors = Object.entries(header).map(([name, entry]) => [presentName(name), entry]);
  return {
    header: Object.fromEntries(tensors) as Json,
    body,
    metadata: { ...metadata, version: 6, errors: withTrainingError(metadata.errors) },
  };
}
