"""All families of attacks, for the long run."""

from attack import support  # noqa: F401  (the long run sets its command)
from faults_test import Faults
from kills_test import Kills
from lies_test import Lies
from limits_test import Descriptors, DiagnosisFileSizes, FileSizes, FullStreams, Memory, Places
from machine_test import Clocks, FailingFlush, LateFiles, PowerLoss
from mutation_test import Mutations
from output_test import Floods, LargeFloods
from torn_test import Torn
from writers_test import Writers

ALL = [Mutations, Lies, Faults, Floods, LargeFloods, Kills, Torn, Writers, FileSizes, DiagnosisFileSizes, Descriptors, Memory, Places,
       FullStreams, PowerLoss, FailingFlush, Clocks, LateFiles]
