/**
 * Species names of inventories (Latin, English, German) and the built-in tree that stands for each. Only populus, acer
 * and prunus have trees of their own; all others are substituted by habit: tall and narrow, broad, or small (assumed).
 * Twin: precompute/galewood/inventory/species.py.
 */

const BUILTIN: Readonly<Record<string, string>> = { populus: "poplar", acer: "maple", prunus: "apricot" };
const NARROW =
  "abies alnus betula calocedrus cedrus chamaecyparis cupressus eucalyptus ginkgo larix liriodendron " +
  "metasequoia picea pinus pseudotsuga salix sequoia sequoiadendron taxodium thuja tsuga";
const BROAD =
  "aesculus ailanthus carpinus carya castanea catalpa celtis fagus fraxinus gleditsia juglans liquidambar " +
  "magnolia ostrya paulownia platanus pterocarya quercus robinia sophora styphnolobium tilia ulmus zelkova";
const SMALL =
  "amelanchier cornus corylus crataegus cydonia elaeagnus ilex juniperus koelreuteria laburnum malus " +
  "mespilus morus olea pyrus sambucus sorbus taxus viburnum";
const COMMON_NAMES =
  "populus:poplar,aspen,cottonwood,pappel,espe,zitterpappel acer:maple,boxelder,ahorn " +
  "prunus:apricot,cherry,plum,almond,peach,blackthorn,aprikose,marille,kirsche,pflaume,zwetschge,zwetschke,mandel,pfirsich,schlehe " +
  "abies:fir,tanne,weisstanne alnus:alder,erle betula:birch,birke cedrus:cedar,zeder " +
  "cupressus:cypress,zypresse ginkgo:maidenhair larix:larch,laerche liriodendron:tuliptree,tulpenbaum " +
  "picea:spruce,fichte pinus:pine,kiefer,foehre,arve,zirbe pseudotsuga:douglas,douglasie " +
  "salix:willow,sallow,osier,weide sequoia:redwood,mammutbaum tsuga:hemlock,hemlocktanne " +
  "thuja:arborvitae,lebensbaum aesculus:horsechestnut,buckeye,rosskastanie ailanthus:goetterbaum " +
  "carpinus:hornbeam,hainbuche,weissbuche carya:hickory,pecan " +
  "castanea:chestnut,kastanie,edelkastanie,esskastanie catalpa:trompetenbaum fagus:beech,buche " +
  "fraxinus:ash,esche gleditsia:honeylocust juglans:walnut,butternut,walnuss,nussbaum " +
  "liquidambar:sweetgum,amberbaum platanus:plane,sycamore,planetree,platane quercus:oak,eiche " +
  "robinia:locust,robinie styphnolobium:schnurbaum tilia:lime,linden,basswood,linde ulmus:elm,ulme,ruester " +
  "cornus:dogwood,hartriegel,kornelkirsche corylus:hazel,hasel crataegus:hawthorn,weissdorn " +
  "cydonia:quince,quitte ilex:holly,stechpalme juniperus:juniper,wacholder laburnum:goldregen " +
  "malus:apple,crabapple,apfel,apfelbaum morus:mulberry,maulbeere,maulbeerbaum olea:olive,olivenbaum " +
  "pyrus:pear,birne,birnbaum sambucus:elder,holunder " +
  "sorbus:rowan,whitebeam,vogelbeere,eberesche,mehlbeere,elsbeere,speierling taxus:yew,eibe";

const standsFor = (names: string, builtin: string) =>
  names.split(" ").map((name) => [name, builtin] as const);

const STANDS_FOR: ReadonlyMap<string, string> = new Map([
  ...Object.entries(BUILTIN),
  ...standsFor(NARROW, "poplar"),
  ...standsFor(BROAD, "maple"),
  ...standsFor(SMALL, "apricot"),
]);

const COMMON: ReadonlyMap<string, string> = new Map(
  COMMON_NAMES.split(" ").flatMap((entry) => {
    const [genus, names] = entry.split(":");
    return names.split(",").map((name) => [name, genus] as const);
  }),
);
/** Letters of a name that may be the end of a German compound, such as eiche in stieleiche. */
const SHORTEST_ENDING = 4;
/** Unknown trees below this height are taken for small ones. */
const SMALL_M = 8;

export interface Match {
  /** The built-in species that stands for the name. */
  readonly builtin: string;
  /** Empty: the name is unknown. */
  readonly genus: string;
  /** Whether it is a tree of the same genus. */
  readonly same: boolean;
}

/** The built-in species for a name; an unknown one is decided by the height. */
export function matchSpecies(name: string, height_m: number): Match {
  const genus = genusOf(name);
  const builtin = STANDS_FOR.get(genus) ?? (height_m < SMALL_M ? "apricot" : "maple");
  return { builtin, genus, same: BUILTIN[genus] === builtin };
}

const known = new Map<string, string>();

/** The genus of a name, remembered: inventories repeat few names. */
function genusOf(name: string): string {
  let genus = known.get(name);
  if (genus === undefined) {
    if (known.size > 4096) known.clear();
    genus = findGenus(name);
    known.set(name, genus);
  }
  return genus;
}

/** The genus of a Latin, English or German name; empty if it is unknown. */
function findGenus(name: string): string {
  const words = plainSpecies(name).split(" ");
  if (STANDS_FOR.has(words[0])) return words[0];
  // the noun comes last in English and in German
  for (const word of [words.join(""), ...words.reverse()]) {
    const own = Object.keys(BUILTIN).find((one) => BUILTIN[one] === word);
    const genus = own ?? COMMON.get(word) ?? compound(word);
    if (genus) return genus;
  }
  return "";
}

function compound(word: string): string | undefined {
  let longest = "";
  for (const name of COMMON.keys()) {
    if (name.length >= SHORTEST_ENDING && name.length > longest.length && word.endsWith(name)) longest = name;
  }
  return COMMON.get(longest);
}

/** A name in lower case: words of letters a to z, umlauts written out, no accents, no brackets. */
export function plainSpecies(name: string): string {
  const text = writtenOut(name.toLowerCase().replace(/[[(].*?[\])]/g, " "))
    .replaceAll("ß", "ss")
    .replaceAll("×", " ");
  return text
    .normalize("NFD")
    .replace(/\p{M}/gu, "")
    .replace(/[^a-z]+/g, " ")
    .trim();
}

/** Umlauts as two letters. */
export const writtenOut = (text: string): string =>
  text.replaceAll("ä", "ae").replaceAll("ö", "oe").replaceAll("ü", "ue");
