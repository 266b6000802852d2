/* The lag of a slow rate is the first term of its series.
 * replaces: lag
 * detected by: x-course in overdamped
 */
double lag(double rate, double tau);

double lag(double rate, double tau)
{
    return 0.5 * rate * tau * tau;
}
