from .fmu.archive import FmuFile as FmuFile
from .fmu.errors import FmuError as FmuError
from .stepping import CommunicationStep as CommunicationStep
from .stepping import Setting as Setting
from .stepping import run as run
