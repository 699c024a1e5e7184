/** Version 5 tables, which differ from version 6 only in names. */

type Json = Record<string, unknown>;

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

/** Header and metadata of a version 5 table under the names of version 6. */
export function fromVersion5<Metadata extends Readonly<Record<string, unknown>>>(
  header: Json,
  metadata: Metadata,
): { header: Json; metadata: Metadata } {
  const tensors = Object.entries(header).map(([name, entry]) => [presentName(name), entry]);
  return {
    header: Object.fromEntries(tensors) as Json,
    metadata: { ...metadata, version: 6, errors: withTrainingError(metadata.errors) },
  };
}
