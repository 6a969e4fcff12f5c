from tests.command_line import ctrl_c_interrupts as ctrl_c_interrupts
from tests.command_line import in_an_empty_folder as in_an_empty_folder
from tests.command_line import run as run
