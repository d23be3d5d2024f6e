// Closures of Aerosol beyond those of the standard: what the shipped materials are made of besides.
#ifndef AEROSOL_CLOSURES_H
#define AEROSOL_CLOSURES_H

// Matte matter below a dielectric boundary, without what the boundary reflects.
closure color coated_diffuse_bsdf(normal N, color albedo, float ior, float roughness, int nonlinear,
                                  string distribution) [[ int builtin = 1 ]];

// Disney's material, solid and as a thin sheet.
closure color principled_bsdf(normal N, vector U, color base_color, float roughness, float anisotropic, float metallic,
                              float spec_trans, float ior, float spec_tint, float sheen, float sheen_tint,
                              float flatness, float clearcoat, float clearcoat_gloss) [[ int builtin = 1 ]];
closure color principled_thin_bsdf(normal N, vector U, color base_color, float roughness, float anisotropic,
                                   float spec_trans, float ior, float spec_tint, float sheen, float sheen_tint,
                                   float flatness, float diff_trans) [[ int builtin = 1 ]];

// Lies on closures (layer) whose normal was turned by a map, and dims light that comes from behind the surface itself.
closure color bump_shadowing(normal N, normal bumped) [[ int builtin = 1 ]];

// A turned normal that the viewer sees from behind, although the surface is seen from its front, leans to the other side.
normal visible_normal(normal turned, normal N, vector I) {
    return dot(turned, I) * dot(N, I) < 0 ? normal(2 * dot(turned, N) * N - turned) : turned;
}

#endif
