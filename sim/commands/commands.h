/* The subcommands of `isotherm-sim`. Each gets argv from its own name on, prints its results on
 * stdout and its complaints on stderr, and returns an exit code. */
#ifndef SIM_COMMANDS_COMMANDS_H
#define SIM_COMMANDS_COMMANDS_H

enum sim_exit {
    SIM_EXIT_OK = 0,
    SIM_EXIT_NO_MATCH = 1,
    SIM_EXIT_USAGE = 2,
    SIM_EXIT_NOT_FOUND = 3,
    SIM_EXIT_FAULT = 4,
    SIM_EXIT_TIMED_OUT = 5,
};

int sim_cmd_generate(int argc, char **argv);
int sim_cmd_import(int argc, char **argv);
int sim_cmd_train(int argc, char **argv);
int sim_cmd_eval(int argc, char **argv);
int sim_cmd_landmarks(int argc, char **argv);
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
