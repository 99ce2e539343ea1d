/* isotherm-hub: the truth of many doors. */
#include "enroll/hub/command/hub_command.h"

int main(int argc, char **argv)
{
    return hub_command_main(argc, argv);
}
