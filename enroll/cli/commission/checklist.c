#include "enroll/cli/commission/checklist.h"

#include <stddef.h>

const struct cli_checklist_item cli_checklist[CLI_CHECKLIST_ITEMS] = {
    {"daemon", CLI_WAY_FINDING, "daemon", "The daemon runs and answers."},
    {"version", CLI_WAY_FINDING, "version", "The daemon and this command have the same version."},
    {"model", CLI_WAY_FINDING, "model", "The head model is loaded."},
    {"image-check", CLI_WAY_FINDING, "image check", "The check of the infrared image is there."},
    {"sensor", CLI_WAY_FINDING, "sensor", "The sensor runs."},
    {"frames", CLI_WAY_FRAMES, NULL, "At least 5 frames a second arrive."},
    {"calibration", CLI_WAY_FINDING, "calibration", "The lens of this camera was measured."},
    {"clock", CLI_WAY_FINDING, "clock", "The clock is set, and not behind the audit log."},
    {"disk", CLI_WAY_FINDING, "disk", "The disk stores what it is given."},
    {"key", CLI_WAY_KEY, NULL, "The key of the appliance is a credential, and not a file."},
    {"log", CLI_WAY_LOG, NULL, "Every record of the audit log is there and unchanged."},
    {"gallery", CLI_WAY_FINDING, "gallery", "The gallery is open, and somebody in it may come in."},
    {"service", CLI_WAY_FINDING, "service", "There is neither a lockdown nor a lock-out."},
    {"lines", CLI_WAY_FINDING, "lines", "The lines of the door are configured and work."},
    {"door", CLI_WAY_FINDING, "door", "The door was not forced, and is not held open."},
    {"thread", CLI_WAY_FINDING, "door thread", "The thread of the door has a real-time priority."},
    {"doctor", CLI_WAY_OTHERS, NULL, "The doctor finds no other fault."},
    {"relay", CLI_WAY_RELAY, NULL, "May the relay be switched for half a second now?"},
    {"unlocks", CLI_WAY_PERSON, NULL, "Could the door be opened while the relay was switched?"},
    {"locks", CLI_WAY_PERSON, NULL, "Is the door locked again, also when you pull at it?"},
    {"contact", CLI_WAY_PERSON, NULL,
     "While you hold the door open, does `isotherm status` say that it is open?"},
    {"tamper", CLI_WAY_PERSON, NULL, "Is an alarm on record when the housing was opened?"},
    {"exit-button", CLI_WAY_PERSON, NULL, "Does the exit button unlock the door?"},
    {"way-out", CLI_WAY_PERSON, NULL,
     "Can everybody leave without the appliance, by a handle or an emergency release?"},
    {"power-loss", CLI_WAY_PERSON, NULL,
     "Without power, was the door as its fire plan demands, locked or unlocked?"},
    {"power-back", CLI_WAY_PERSON, NULL, "When the power came back, was the door locked at once?"},
    {"admitted", CLI_WAY_PERSON, NULL, "Does the door open to an enrolled person?"},
    {"stranger", CLI_WAY_PERSON, NULL, "Does it stay locked for somebody who is not enrolled?"},
    {"photo", CLI_WAY_PERSON, NULL,
     "Does it stay locked for a printed photo of an enrolled person?"},
    {"cable", CLI_WAY_PERSON, NULL,
     "Are the cables of lock and camera, and the relay, out of reach from outside?"},
    {"notice", CLI_WAY_PERSON, NULL,
     "Do people see that faces are recognised here, and has everybody enrolled consented?"},
};

bool cli_checklist_asks(const struct cli_checklist_item *item)
{
    return item->way == CLI_WAY_RELAY || item->way == CLI_WAY_PERSON;
}
