/* A controller outside a bench, which does what the built-in feedback `individual` of the three-mass rotor does:
 *
 *     cc -O2 -ffp-contract=off -I crates/wire -o controller crates/wire/c/controller.c
 *     whirl sim three-mass --bench lab --feedback individual --set sample=0.01 --set delay=0.01 --set external=20 &
 *     whirl control --bench lab -- ./controller
 *
 * `whirl control` writes the readings of every sample to its standard input and takes the command from its standard output, both as they are
 * in whirl.h. -ffp-contract=off keeps the last bit where a processor could multiply and add at once. */
#include <stdio.h>

#include "whirl.h"

/* Of each sensor kd, cd, kc, cc: u = - sum [(kd - j kc) p + (cd - j cc) p']. */
static const double gains[2][4] = {{4.0, 3.1168, 3.1241, 0.9175}, {-2.3419, 4.0, -3.7635, 4.0}};

int main(void) {
    struct whirl_readings readings;
    while (fread(&readings, sizeof readings, 1, stdin) == 1) {
        struct whirl_control_command command = {0};
        double uy = 0.0, uz = 0.0;
        for (int k = 0; k < 2; k++) {
            const double kd = gains[k][0], cd = gains[k][1], kc = gains[k][2], cc = gains[k][3];
            const double y = readings.readings[k][0], z = readings.readings[k][1];
            const double vy = readings.readings[k][2], vz = readings.readings[k][3];
            uy -= (kd * y - -kc * z) + (cd * vy - -cc * vz);
            uz -= (kd * z + -kc * y) + (cd * vz + -cc * vy);
        }
        command.run_id = readings.run_id;
        command.number = readings.number;
        command.command[0][0] = uy;
        command.command[0][1] = uz;
        if (fwrite(&command, sizeof command, 1, stdout) != 1 || fflush(stdout) != 0) {
            return 1;
        }
    }
    return 0;
}
