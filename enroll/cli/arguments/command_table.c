#include "enroll/cli/arguments/command_table.h"

const struct cli_command cli_commands[CLI_VERBS] = {
    [CLI_ENROLL] = {"enroll", "NAME", "enrol the person in front of the camera as NAME"},
    [CLI_IDENTIFY] = {"identify", "", "tell who is in front of the camera"},
    [CLI_VERIFY] = {"verify", "NAME", "tell whether NAME is in front of the camera"},
    [CLI_LIST] = {"list", "", "list the enrolled people"},
    [CLI_REMOVE] = {"remove", "NAME", "delete NAME and every template of NAME"},
    [CLI_VALIDITY] = {"validity", "NAME", "change from when and until when NAME may come in"},
    [CLI_RENAME] = {"rename", "OLD NEW", "change the name of an enrolled person"},
    [CLI_STATUS] = {"status", "", "show the state of the appliance"},
    [CLI_SITE] = {"site", "[show|reset|rollback]",
                  "show what the people have taught the metric, or take it back"},
    [CLI_LOG] = {"log", "[verify]", "show the audit log, or verify that it is sound"},
    [CLI_DOCTOR] = {"doctor", "", "look for faults and tell how to correct them"},
    [CLI_AIM] = {"aim", "", "show what the sensor sees, to place and turn it"},
    [CLI_EXPORT] = {"export", "FILE", "write people into a sealed file, for another door"},
    [CLI_IMPORT] = {"import", "FILE", "add the people of such a file"},
    [CLI_KEY] = {"key", "rotate|address", "seal all files with new keys; show the address"},
    [CLI_LOCKDOWN] = {"lockdown", "on|off", "admit nobody until it is switched off"},
    [CLI_LOCKOUT] = {"lockout", "clear", "end a lock-out and reset its counts"},
    [CLI_SETUP] = {"setup", "", "find camera and board, configure the daemon and start it"},
    [CLI_DOOR] = {"door", "test", "unlock the door for half a second"},
};
