#include "enroll/cli/arguments/command_table.h"

const struct cli_command cli_commands[CLI_VERBS] = {
    [CLI_ENROLL] = {"enroll", "NAME", "enrol the person in front of the camera as NAME"},
    [CLI_IDENTIFY] = {"identify", "", "say who is in front of the camera"},
    [CLI_VERIFY] = {"verify", "NAME", "say whether NAME is in front of the camera"},
    [CLI_LIST] = {"list", "", "list the enrolled people"},
    [CLI_REMOVE] = {"remove", "NAME", "delete NAME and every template of NAME"},
    [CLI_VALIDITY] = {"validity", "NAME", "change from when and until when the door opens to NAME"},
    [CLI_RENAME] = {"rename", "OLD NEW", "give somebody who is enrolled another name"},
    [CLI_STATUS] = {"status", "", "show the state of the appliance"},
    [CLI_LOG] = {"log", "[verify]", "show the audit log, or say whether it is sound"},
    [CLI_DOCTOR] = {"doctor", "", "look for faults and say how to mend them"},
    [CLI_AIM] = {"aim", "", "show what the sensor sees, to place and turn it"},
    [CLI_EXPORT] = {"export", "FILE", "write people into a sealed file, for another door"},
    [CLI_IMPORT] = {"import", "FILE", "take people over from such a file"},
    [CLI_KEY] = {"key", "rotate|address", "seal everything with new keys; show the address"},
    [CLI_LOCKDOWN] = {"lockdown", "on|off", "let nobody in, whoever it is, until it is off"},
    [CLI_LOCKOUT] = {"lockout", "clear", "end a lock-out after failures, and forget them"},
    [CLI_SETUP] = {"setup", "", "find camera and board, configure the daemon and start it"},
    [CLI_DOOR] = {"door", "test", "have the relay click once, for half a second"},
};
