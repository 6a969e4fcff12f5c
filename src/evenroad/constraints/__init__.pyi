from evenroad.constraints.linked import KeepJoints as KeepJoints
from evenroad.constraints.linked import KeepOnCircle as KeepOnCircle
from evenroad.constraints.linked import KeepTogether as KeepTogether
from evenroad.constraints.tip import KeepInBox as KeepInBox
from evenroad.constraints.tip import KeepInPlane as KeepInPlane
from evenroad.constraints.tip import KeepOnLine as KeepOnLine
from evenroad.constraints.tip import KeepOrientation as KeepOrientation
from evenroad.constraints.tip import KeepUpright as KeepUpright
