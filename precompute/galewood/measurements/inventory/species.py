"""Species names of inventories (Latin, English, German) and the built-in tree that stands for each.

Eleven genera have trees of their own, and sycamore beside the other maples. All others are substituted by
habit: conical, tall and narrow, broad, with feathered leaves, or small; an assumption.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

BUILTIN_SPECIES = {
    "populus": "poplar",
    "acer": "maple",
    "prunus": "apricot",
    "betula": "birch",
    "quercus": "oak",
    "fagus": "beech",
    "fraxinus": "ash",
    "salix": "willow",
    "picea": "spruce",
    "pinus": "pine",
    "larix": "larch",
}
SYCAMORE_TREE = "sycamore"
"""The built-in tree of one species of maple."""
BUILTIN_NAMES = (*BUILTIN_SPECIES.values(), SYCAMORE_TREE)
_CONICAL = (
    "abies calocedrus cedrus chamaecyparis cupressus juniperus pseudotsuga sequoia sequoiadendron taxus "
    "thuja tsuga"
)
_SUBSTITUTES = {
    "spruce": _CONICAL,
    "larch": "metasequoia taxodium",
    "poplar": "eucalyptus ginkgo liriodendron",
    "birch": "alnus",
    "beech": "carpinus castanea celtis ostrya tilia ulmus zelkova",
    "sycamore": "aesculus catalpa liquidambar paulownia platanus",
    "ash": "ailanthus carya gleditsia juglans pterocarya robinia sophora styphnolobium",
    "maple": "magnolia",
    "apricot": "amelanchier cornus corylus crataegus cydonia elaeagnus ilex koelreuteria laburnum malus "
    "mespilus morus olea pyrus sambucus sorbus viburnum",
}
STANDS_FOR: dict[str, str] = {
    **{genus: builtin for builtin, genera in _SUBSTITUTES.items() for genus in genera.split()},
    **BUILTIN_SPECIES,
}
WOODS: dict[str, str] = {
    **dict.fromkeys([*_CONICAL.split(), *_SUBSTITUTES["larch"].split()], "conifer"),
    "platanus": "plane",
    **BUILTIN_SPECIES,
}
"""Species of wood (galewood.wood) by genus; all others have an average one."""
SYCAMORE_NAMES = ("pseudoplatanus", "bergahorn", "sycamore maple")
SYCAMORE_ABBREVIATIONS = ("bah", "acps")
_COMMON = (
    "populus:poplar,aspen,cottonwood,pappel,espe,zitterpappel acer:maple,boxelder,ahorn "
    "prunus:apricot,cherry,plum,almond,peach,blackthorn,aprikose,marille,kirsche,pflaume,zwetschge,"
    "zwetschke,mandel,pfirsich,schlehe abies:fir,tanne,weisstanne alnus:alder,erle betula:birch,birke "
    "cedrus:cedar,zeder cupressus:cypress,zypresse ginkgo:maidenhair larix:larch,laerche "
    "liriodendron:tuliptree,tulpenbaum picea:spruce,fichte pinus:pine,kiefer,foehre,arve,zirbe "
    "pseudotsuga:douglas,douglasie salix:willow,sallow,osier,weide sequoia:redwood,mammutbaum "
    "tsuga:hemlock,hemlocktanne thuja:arborvitae,lebensbaum aesculus:horsechestnut,buckeye,rosskastanie "
    "ailanthus:goetterbaum carpinus:hornbeam,hainbuche,weissbuche carya:hickory,pecan "
    "castanea:chestnut,kastanie,edelkastanie,esskastanie catalpa:trompetenbaum fagus:beech,buche "
    "fraxinus:ash,esche gleditsia:honeylocust juglans:walnut,butternut,walnuss,nussbaum "
    "liquidambar:sweetgum,amberbaum platanus:plane,sycamore,planetree,platane quercus:oak,eiche "
    "robinia:locust,robinie styphnolobium:schnurbaum tilia:lime,linden,basswood,linde ulmus:elm,ulme,ruester "
    "cornus:dogwood,hartriegel,kornelkirsche corylus:hazel,hasel crataegus:hawthorn,weissdorn "
    "cydonia:quince,quitte ilex:holly,stechpalme juniperus:juniper,wacholder laburnum:goldregen "
    "malus:apple,crabapple,apfel,apfelbaum morus:mulberry,maulbeere,maulbeerbaum olea:olive,olivenbaum "
    "pyrus:pear,birne,birnbaum sambucus:elder,holunder "
    "sorbus:rowan,whitebeam,vogelbeere,eberesche,mehlbeere,elsbeere,speierling taxus:yew,eibe"
)
_ABBREVIATIONS = (
    "picea:fi,gfi,ofi,pfi,piab pinus:ki,gki,wki,ski,zir,pisy,pini larix:lae,la,elae,ela,jlae,jla,hla,lade "
    "abies:ta,wta,kta,abal pseudotsuga:dgl,dg,psme taxus:eib fagus:bu,rbu,fasy "
    "quercus:ei,sei,stei,tei,trei,rei,quro,qupe,quru carpinus:hbu,hb,cabe fraxinus:es,ges,frex "
    "acer:ah,bah,sah,fah,acps,acpl,acca ulmus:ul,rue,bul,ful robinia:rob,rops prunus:kir,vki,vkb,prav "
    "betula:bi,gbi,mbi,bepe,bepu alnus:er,rer,ser,wer,algl populus:pa,as,asp,potr tilia:li,wli,sli,tico "
    "salix:wei sorbus:vb,ebe,els juglans:nus castanea:eka,casa"
)
"""Whole names only: of German and Austrian forest inventories (Fi, Bu, SEi, BAh; as Sachsenforst and the
Österreichische Waldinventur list them), and the first letters of genus and species (FASY)."""


def _genera(entries: str) -> dict[str, str]:
    pairs = [entry.split(":") for entry in entries.split()]
    return {name: genus for genus, names in pairs for name in names.split(",")}


COMMON_NAMES = _genera(_COMMON)
ABBREVIATIONS = _genera(_ABBREVIATIONS)
SHORTEST_ENDING = 4
"""Letters of a name that may be the end of a German compound, such as eiche in stieleiche."""
SMALL_M = 8.0
"""Unknown trees below this height are taken for small ones."""


@dataclass(frozen=True)
class Match:
    """The built-in species that stands for a name."""

    builtin: str
    genus: str
    """Empty: the name is unknown."""

    @property
    def same(self) -> bool:
        """Whether it is a tree of the same genus."""
        own = BUILTIN_SPECIES.get(self.genus)
        return self.builtin == own or (self.builtin == SYCAMORE_TREE and own == "maple")


def match_species(name: str, height_m: float) -> Match:
    """The built-in species for a name; an unknown one is decided by the height."""
    if _is_sycamore(name):
        return Match(SYCAMORE_TREE, "acer")
    genus = genus_of(name)
    if genus:
        return Match(STANDS_FOR[genus], genus)
    return Match("apricot" if height_m < SMALL_M else "maple", "")


def wood_species_of(name: str) -> str:
    """The species of wood (galewood.wood) for a name; "default" for one that has none of its own."""
    if _is_sycamore(name):
        return SYCAMORE_TREE
    return WOODS.get(genus_of(name), "default")


def _is_sycamore(name: str) -> bool:
    words = plain(name)
    return words in SYCAMORE_ABBREVIATIONS or any(known in words for known in SYCAMORE_NAMES)


@lru_cache(maxsize=4096)
def genus_of(name: str) -> str:
    """The genus of a Latin, English or German name; empty if it is unknown."""
    words = plain(name).split(" ")
    if words[0] in STANDS_FOR:
        return words[0]
    whole = "".join(words)
    if whole in ABBREVIATIONS:
        return ABBREVIATIONS[whole]
    # the noun comes last in English and in German
    for word in [whole, *reversed(words)]:
        if word in BUILTIN_SPECIES.values():
            return next(genus for genus, builtin in BUILTIN_SPECIES.items() if builtin == word)
        if found := _common(word):
            return found
    return ""


def _common(word: str) -> str:
    if word in COMMON_NAMES:
        return COMMON_NAMES[word]
    endings = [name for name in COMMON_NAMES if len(name) >= SHORTEST_ENDING and word.endswith(name)]
    return COMMON_NAMES[max(endings, key=len)] if endings else ""


def plain(name: str) -> str:
    """A name in lower case: words of letters a to z, umlauts written out, no accents, no brackets."""
    text = re.sub(r"[\[(].*?[\])]", " ", name.lower())
    for letter, written in {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "×": " "}.items():
        text = text.replace(letter, written)
    text = "".join(one for one in unicodedata.normalize("NFD", text) if not unicodedata.combining(one))
    return re.sub(r"[^a-z]+", " ", text).strip()
