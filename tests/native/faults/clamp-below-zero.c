/* The clamp of a small static coefficient goes below zero.
 * replaces: kinetic_coefficient
 * detected by: mu_k_used-course in clamp-to-zero
 */
double kinetic_coefficient(double mu_s, double mu_k);

double kinetic_coefficient(double mu_s, double mu_k)
{
    return mu_k <= mu_s ? mu_k : mu_s - 0.01;
}
