/* What `isotherm setup` shows at its end: one picture of what the camera sees, and the findings of
 * `isotherm doctor`. */
#ifndef CLI_SETUP_SHOW_H
#define CLI_SETUP_SHOW_H

#include "enroll/cli/doctor/diagnosis.h"
#include "enroll/cli/setup/setup.h"

/* Saves the picture as wish->picture and shows it at the terminal. Tries again for some seconds
 * while another program has the camera or the daemon is not on the bus yet, but not after the
 * daemon has reported that the camera shows nothing. If there is no picture, it prints the reason
 * on dialogue->out and returns false; that is no failure of the setup. */
bool cli_setup_show_picture(const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue);

/* Examines the appliance, as `isotherm doctor` does, and prints the findings, unless wish->json.
 * *out receives them. */
void cli_setup_show_diagnosis(const struct cli_setup_wish *wish,
                              const struct cli_dialogue *dialogue, struct cli_diagnosis *out);

#endif
