// Complex indices of refraction of metals and other crystals, as linear Rec.709 colours: measured spectra (the tables of
// SOPRA and of Palik's handbook) weighted by the CIE 1931 observer.
#ifndef AEROSOL_METALS_H
#define AEROSOL_METALS_H

// The indices of a material; 0 when the name is unknown. "none" reflects everything.
int metal_indices(string material, output color eta, output color k) {
  int known = 1;
  if (material == "none") { eta = 0; k = 1; }
  else if (material == "a-C") { eta = color(2.944, 2.227, 1.968); k = color(0.8875, 0.7993, 0.8153); }
  else if (material == "Ag") { eta = color(0.1553, 0.1167, 0.1384); k = color(4.828, 3.122, 2.147); }
  else if (material == "Al") { eta = color(1.657, 0.8804, 0.5212); k = color(9.224, 6.269, 4.837); }
  else if (material == "AlAs") { eta = color(3.605, 3.233, 2.216); k = color(0.0006794, 0, 0.007513); }
  else if (material == "AlAs_palik") { eta = color(3.605, 3.233, 2.216); k = color(0.0006794, 0, 0.007513); }
  else if (material == "AlSb") { eta = color(0, 4.139, 4.669); k = color(0, 0.09401, 1.301); }
  else if (material == "AlSb_palik") { eta = color(0, 4.139, 4.669); k = color(0, 0.09401, 1.301); }
  else if (material == "Au") { eta = color(0.143, 0.3753, 1.442); k = color(3.983, 2.386, 1.603); }
  else if (material == "Be") { eta = color(4.185, 3.185, 2.784); k = color(3.835, 3.01, 2.869); }
  else if (material == "Be_palik") { eta = color(4.185, 3.185, 2.784); k = color(3.835, 3.01, 2.869); }
  else if (material == "Cr") { eta = color(4.37, 2.917, 1.655); k = color(5.207, 4.231, 3.755); }
  else if (material == "CsI") { eta = color(2.145, 1.702, 1.662); k = color(0, 0, 0); }
  else if (material == "CsI_palik") { eta = color(2.145, 1.702, 1.662); k = color(0, 0, 0); }
  else if (material == "Cu") { eta = color(0.201, 0.9237, 1.102); k = color(3.913, 2.453, 2.142); }
  else if (material == "Cu2O") { eta = color(3.552, 2.95, 2.752); k = color(0.1142, 0.1939, 0.6061); }
  else if (material == "Cu2O_palik") { eta = color(3.552, 2.95, 2.752); k = color(0.1142, 0.1939, 0.6061); }
  else if (material == "Cu_palik") { eta = color(0.2132, 0.9197, 1.102); k = color(3.922, 2.457, 2.137); }
  else if (material == "CuO") { eta = color(3.248, 2.448, 2.21); k = color(0.5211, 0.57, 0.7222); }
  else if (material == "CuO_palik") { eta = color(3.248, 2.448, 2.21); k = color(0.5211, 0.57, 0.7222); }
  else if (material == "d-C") { eta = color(2.709, 2.319, 2.229); k = color(0, 0, 0); }
  else if (material == "d-C_palik") { eta = color(2.709, 2.319, 2.229); k = color(0, 0, 0); }
  else if (material == "Hg") { eta = color(2.399, 1.44, 0.9096); k = color(6.328, 4.372, 3.422); }
  else if (material == "Hg_palik") { eta = color(2.399, 1.44, 0.9096); k = color(6.328, 4.372, 3.422); }
  else if (material == "HgTe") { eta = color(4.779, 3.231, 2.66); k = color(1.632, 1.581, 1.729); }
  else if (material == "HgTe_palik") { eta = color(4.779, 3.231, 2.66); k = color(1.632, 1.581, 1.729); }
  else if (material == "Ir") { eta = color(3.086, 2.082, 1.618); k = color(5.592, 4.067, 3.267); }
  else if (material == "Ir_palik") { eta = color(3.086, 2.082, 1.618); k = color(5.592, 4.067, 3.267); }
  else if (material == "K") { eta = color(0.06404, 0.04641, 0.03818); k = color(2.104, 1.349, 0.9131); }
  else if (material == "K_palik") { eta = color(0.06404, 0.04641, 0.03818); k = color(2.104, 1.349, 0.9131); }
  else if (material == "Li") { eta = color(0.2658, 0.1956, 0.2209); k = color(3.54, 2.311, 1.669); }
  else if (material == "Li_palik") { eta = color(0.2658, 0.1956, 0.2209); k = color(3.54, 2.311, 1.669); }
  else if (material == "MgO") { eta = color(2.09, 1.651, 1.595); k = color(0, 0, 0); }
  else if (material == "MgO_palik") { eta = color(2.09, 1.651, 1.595); k = color(0, 0, 0); }
  else if (material == "Mo") { eta = color(4.484, 3.525, 2.776); k = color(4.111, 3.421, 3.151); }
  else if (material == "Mo_palik") { eta = color(4.484, 3.525, 2.776); k = color(4.111, 3.421, 3.151); }
  else if (material == "Na_palik") { eta = color(0.06027, 0.05614, 0.06199); k = color(3.179, 2.112, 1.579); }
  else if (material == "Nb") { eta = color(3.42, 2.79, 2.396); k = color(3.441, 2.738, 2.58); }
  else if (material == "Nb_palik") { eta = color(3.42, 2.79, 2.396); k = color(3.441, 2.738, 2.58); }
  else if (material == "Ni_palik") { eta = color(2.367, 1.663, 1.467); k = color(4.499, 3.05, 2.345); }
  else if (material == "Rh") { eta = color(2.586, 1.86, 1.554); k = color(6.782, 4.703, 3.976); }
  else if (material == "Rh_palik") { eta = color(2.586, 1.86, 1.554); k = color(6.782, 4.703, 3.976); }
  else if (material == "Se") { eta = color(4.058, 2.843, 2.821); k = color(0.754, 0.6384, 0.5218); }
  else if (material == "Se-e") { eta = color(5.723, 4.166, 4.081); k = color(0.8711, 1.105, 1.565); }
  else if (material == "Se-e_palik") { eta = color(5.723, 4.166, 4.081); k = color(0.8711, 1.105, 1.565); }
  else if (material == "Se_palik") { eta = color(4.058, 2.843, 2.821); k = color(0.754, 0.6384, 0.5218); }
  else if (material == "SiC") { eta = color(3.172, 2.526, 2.479); k = color(0, 0, 0); }
  else if (material == "SiC_palik") { eta = color(3.172, 2.526, 2.479); k = color(7.538e-07, 0, 1.019e-05); }
  else if (material == "SnTe") { eta = color(4.524, 1.982, 1.282); k = color(0, 0, 0); }
  else if (material == "SnTe_palik") { eta = color(4.524, 1.982, 1.282); k = color(0, 0, 0); }
  else if (material == "Ta") { eta = color(2.063, 2.393, 2.628); k = color(2.408, 1.741, 1.947); }
  else if (material == "Ta_palik") { eta = color(2.063, 2.393, 2.628); k = color(2.408, 1.741, 1.947); }
  else if (material == "Te") { eta = color(7.39, 4.482, 2.637); k = color(3.256, 3.527, 3.292); }
  else if (material == "Te-e") { eta = color(7.509, 4.296, 2.37); k = color(5.584, 4.947, 3.998); }
  else if (material == "Te-e_palik") { eta = color(7.509, 4.296, 2.37); k = color(5.584, 4.947, 3.998); }
  else if (material == "Te_palik") { eta = color(7.39, 4.482, 2.637); k = color(3.256, 3.527, 3.292); }
  else if (material == "ThF4") { eta = color(1.831, 1.442, 1.388); k = color(0, 0, 0); }
  else if (material == "ThF4_palik") { eta = color(1.831, 1.442, 1.388); k = color(0, 0, 0); }
  else if (material == "TiC") { eta = color(3.701, 2.837, 2.582); k = color(3.266, 2.352, 2.173); }
  else if (material == "TiC_palik") { eta = color(3.701, 2.837, 2.582); k = color(3.266, 2.352, 2.173); }
  else if (material == "TiN") { eta = color(1.648, 1.151, 1.38); k = color(3.368, 1.944, 1.102); }
  else if (material == "TiN_palik") { eta = color(1.648, 1.151, 1.38); k = color(3.368, 1.943, 1.102); }
  else if (material == "TiO2") { eta = color(3.457, 2.802, 2.905); k = color(0.0001053, 0, 0.0006529); }
  else if (material == "TiO2-e") { eta = color(3.107, 2.513, 2.582); k = color(2.975e-05, 0, 0.0001827); }
  else if (material == "TiO2-e_palik") { eta = color(3.107, 2.513, 2.582); k = color(2.975e-05, 0, 0.0001827); }
  else if (material == "TiO2_palik") { eta = color(3.457, 2.802, 2.905); k = color(0.0001053, 0, 0.0006529); }
  else if (material == "V_palik") { eta = color(4.278, 3.513, 2.761); k = color(3.491, 2.889, 3.112); }
  else if (material == "VC") { eta = color(3.658, 2.753, 2.533); k = color(3.068, 2.199, 1.963); }
  else if (material == "VC_palik") { eta = color(3.658, 2.753, 2.533); k = color(3.068, 2.199, 1.963); }
  else if (material == "VN") { eta = color(2.866, 2.119, 1.94); k = color(3.032, 2.056, 1.616); }
  else if (material == "VN_palik") { eta = color(2.866, 2.119, 1.94); k = color(3.032, 2.056, 1.616); }
  else if (material == "W") { eta = color(4.371, 3.3, 2.998); k = color(3.501, 2.605, 2.273); }
  else known = 0;
  return known;
}

#endif
