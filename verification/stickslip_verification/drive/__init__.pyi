from .fmu.archive import FmuFile as FmuFile
from .fmu.errors import FmuError as FmuError
from .masters import run as run
from .stepping import CommunicationStep as CommunicationStep
from .stepping import Setting as Setting
