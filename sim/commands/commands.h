/* The subcommands of `isotherm-sim`. Each gets an argv that begins with its own name, prints
 * results to stdout and errors to stderr, and returns an exit code. */
#ifndef SIM_COMMANDS_COMMANDS_H
#define SIM_COMMANDS_COMMANDS_H

enum sim_exit {
    SIM_EXIT_OK = 0,
    SIM_EXIT_NO_MATCH = 1,  /* the command worked, but its result is negative: no usable face, or
                               visits that went wrong */
    SIM_EXIT_USAGE = 2,     /* invalid arguments */
    SIM_EXIT_NOT_FOUND = 3, /* a file or a device is missing */
    SIM_EXIT_FAULT = 4,     /* any other error */
    SIM_EXIT_TIMED_OUT = 5, /* no frame came, or the door did not lock again */
};

int sim_cmd_generate(int argc, char **argv);
int sim_cmd_import(int argc, char **argv);
int sim_cmd_train(int argc, char **argv);
int sim_cmd_eval(int argc, char **argv);
int sim_cmd_landmarks(int argc, char **argv);
int sim_cmd_outlines(int argc, char **argv);
int sim_cmd_shapes(int argc, char **argv);
int sim_cmd_show(int argc, char **argv);
int sim_cmd_levels(int argc, char **argv);
int sim_cmd_replay(int argc, char **argv);
int sim_cmd_record(int argc, char **argv);
int sim_cmd_sensor(int argc, char **argv);
#ifdef ISOTHERM_STEREO
int sim_cmd_calibrate(int argc, char **argv);
#endif
int sim_cmd_visit(int argc, char **argv);

#endif
