/** How uploaded trees are planted in this visitor's forest. Built-in species are always planted. Pure. */

/** One in the clearing; also among the other trees, like a species; or no other tree in the forest. */
export const PLANTED_CHOICES = ["one", "more", "only"] as const;
export type Planted = (typeof PLANTED_CHOICES)[number];

/** By the id of the upload; one that is missing is not planted. The order is that of the places in the clearing. */
export type PlantedTrees = Readonly<Record<string, Planted>>;

export interface PlantedSettings {
  planted: PlantedTrees;
}

const MOST_TREES = 64;

const isPlanted = (text: string): text is Planted => (PLANTED_CHOICES as readonly string[]).includes(text);

/** Parses "id,id:more"; invalid parts are ignored. */
export function plantedFrom(text: string): PlantedTrees {
  const planted: Record<string, Planted> = {};
  for (const part of text.split(",").slice(0, MOST_TREES)) {
    const [, id, how = "one"] = /^([\w-]{1,64})(?::(\w+))?$/.exec(part) ?? [];
    if (id && isPlanted(how)) planted[id] = how;
  }
  return planted;
}

export const textOfPlanted = (planted: PlantedTrees): string =>
  Object.entries(planted)
    .map(([id, how]) => (how === "one" ? id : `${id}:${how}`))
    .join(",");

/** How an upload is planted; null if it is not. */
export const plantedAs = ({ planted }: PlantedSettings, id: string): Planted | null => planted[id] ?? null;

/** Changes how an upload is planted; null removes it. */
export function plantAs(settings: PlantedSettings, id: string, how: Planted | null): void {
  const { [id]: _before, ...others } = settings.planted;
  const known = id in settings.planted;
  if (how === null) settings.planted = others;
  else settings.planted = known ? { ...settings.planted, [id]: how } : { ...others, [id]: how };
}
